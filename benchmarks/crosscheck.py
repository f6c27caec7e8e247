"""Compare the mechanics with MuJoCo: the paper's two regrasps and random three-phase motions with one to four fingers.

The hand moves exactly as planned. A lone finger is compared with the event-driven simulation, several fingers with
implicit stepping, extrapolated from two steps.
"""

import argparse
import time
from dataclasses import dataclass

import numpy as np
from support.motions import Case, linear, random_case, rotational
from support.plain_python import PlainTrial

from slidepipe.lab.grip_model import FINGER_MASS_KG, ContactSettings
from slidepipe.lab.planar_rig import REST_S, planar_rig, run_rig
from slidepipe.mechanics.simulate import simulate
from slidepipe.mechanics.stepping import step_through
from slidepipe.series import FloatArray

HEAVY_FINGER_KG = 0.005
"""Spheres of this mass show how much their hopping does."""
STEP_S = 5e-5
"""Of the implicit stepping; the other step is twice as long."""
SLID_M = 1e-3
MARGIN_M = 1e-3
"""What a random motion must slide at least, and how far inside the face its fingers must stay."""
WORST = 5
FINER = (1.0, 2.5, 5.0)
"""How much shorter MuJoCo's steps are when a difference is explained."""
NUDGE = 1e-3
"""Share of the friction by which the sensitivity is taken."""


@dataclass(frozen=True, slots=True)
class Difference:
    """Final relative pose (3,) of a case by our mechanics, and what MuJoCo's is apart from it."""

    case: Case
    ours: FloatArray
    apart: FloatArray

    @property
    def position_mm(self) -> float:
        """How far apart the places are."""
        return 1e3 * float(np.hypot(*self.apart[:2]))

    @property
    def angle_mrad(self) -> float:
        """How far apart the angles are."""
        return 1e3 * abs(float(self.apart[2]))


def main() -> None:
    """Print the table of differences."""
    options = _options()
    contact = ContactSettings(options.timestep, options.solref, options.impratio)
    print(
        f"MuJoCo: elliptic cone, condim 4, solref {contact.solref_s:g} s, impratio {contact.impratio:g}, timestep "
        f"{contact.timestep_s:g} s, {1e3 * FINGER_MASS_KG:g} g a sphere, solimp 0.99, solreffriction two steps"
    )
    began = time.perf_counter()
    found = [_compare(case, contact) for case in (linear(), rotational())]
    found += [_compare(case, contact) for case in _random_cases(options.count, options.seed)]
    _print_paper(found[:2], contact)
    if options.count:
        _print_spread(found[2:])
        _print_worst(found[2:], contact)
    print(f"{time.perf_counter() - began:.0f} s")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200, help="random motions")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--timestep", type=float, default=5e-5, help="of MuJoCo, s")
    parser.add_argument("--solref", type=float, default=2e-4, help="time constant of MuJoCo's normal contact, s")
    parser.add_argument("--impratio", type=float, default=1000.0)
    return parser.parse_args()


def _random_cases(count: int, seed: int) -> list[Case]:
    random, cases, left, idle = np.random.default_rng(seed), [], 0, 0
    while len(cases) < count:
        fingers = 1 + len(cases) % 4
        case = random_case(random, f"random {len(cases) + 1}", fingers)
        path = _stepped(case, 4.0 * STEP_S)
        if case.margin_m(path) < MARGIN_M:
            left += 1
        elif np.max(np.abs(path[:, :2] - path[0, :2])) < SLID_M:
            idle += 1
        else:
            cases.append(case)
    print(f"{count} random motions; drawn again: {left} whose fingers leave the face, {idle} that hardly slide")
    return cases


def _stepped(case: Case, step_s: float) -> FloatArray:
    time_s = case.hand.breaks[0] + step_s * np.arange(round((case.hand.breaks[-1] + REST_S) / step_s) + 1)
    return step_through(time_s, case.hand.at(time_s), case.block, case.fingers, case.r_f_b).r_f_b


def _ours(case: Case) -> FloatArray:
    """Last relative pose (3,)."""
    if case.lone is not None:
        return simulate(case.hand, case.block, case.lone, case.r_f_b).r_f_b
    return 2.0 * _stepped(case, STEP_S)[-1] - _stepped(case, 2.0 * STEP_S)[-1]


def _theirs(case: Case, contact: ContactSettings, finger_mass_kg: float = FINGER_MASS_KG) -> FloatArray:
    rig = planar_rig(case.block, case.fingers, contact, finger_mass_kg=finger_mass_kg)
    return run_rig(rig, case.hand, case.r_f_b).r_f_b[-1]


def _compare(case: Case, contact: ContactSettings, finger_mass_kg: float = FINGER_MASS_KG) -> Difference:
    ours = _ours(case)
    return Difference(case, ours, _theirs(case, contact, finger_mass_kg) - ours)


def _print_paper(found: list[Difference], contact: ContactSettings) -> None:
    print("\nthe paper's regrasps            position mm   angle mrad")
    for one in found:
        heavy = _compare(one.case, contact, HEAVY_FINGER_KG)
        for name, what in ((one.case.name, one), (f"  with spheres of {1e3 * HEAVY_FINGER_KG:g} g", heavy)):
            print(f"{name:30s} {what.position_mm:12.4f} {what.angle_mrad:12.3f}")


def _print_spread(found: list[Difference]) -> None:
    print("\nrandom motions        position mm: median      95 %     worst   angle mrad: median     95 %    worst")
    for count in (1, 2, 3, 4, 0):
        some = [one for one in found if count in (0, len(one.case.fingers))]
        if not some:
            continue
        name = f"{count} finger{'s' * (count > 1)}" if count else "all"
        mm, mrad = (np.array([getattr(one, key) for one in some]) for key in ("position_mm", "angle_mrad"))
        first = "".join(f"{value:10.4f}" for value in (np.median(mm), np.quantile(mm, 0.95), np.max(mm)))
        second = "".join(f"{value:9.3f}" for value in (np.median(mrad), np.quantile(mrad, 0.95), np.max(mrad)))
        print(f"{name:10s} {len(some):4d}               {first}           {second}")


def _print_worst(found: list[Difference], contact: ContactSettings) -> None:
    """The worst, with what tells why: MuJoCo at finer steps, what a little friction does, and how sure ours is."""
    steps = " |".join(f"{'at ' + format(contact.timestep_s / finer, 'g') + ' s':>18s}" for finer in FINER)
    print(
        f"\nthe worst, each mm and mrad; MuJoCo also with shorter steps and solref, extrapolated from the last two"
        f"\n{'':12s}  n slides |{steps} |   extrapolated    |  friction {100 * NUDGE:+g} %   |   ours less check"
    )
    for one in sorted(found, key=lambda one: -one.position_mm)[:WORST]:
        _explain(one, contact)


def _explain(one: Difference, contact: ContactSettings) -> None:
    case, finer = one.case, [one]
    for share in FINER[1:]:
        shorter = ContactSettings(contact.timestep_s / share, contact.solref_s / share, contact.impratio)
        finer.append(Difference(case, one.ours, _theirs(case, shorter) - one.ours))
    ratio = FINER[-1] / FINER[-2]
    limit = Difference(case, one.ours, (ratio * finer[-1].apart - finer[-2].apart) / (ratio - 1.0))
    nudged = Difference(case, one.ours, _ours(case.with_friction(1.0 + NUDGE)) - one.ours)
    check = Difference(case, one.ours, one.ours - _checked(case))
    pairs = " |".join(f"{d.position_mm:9.4f} {d.angle_mrad:8.3f}" for d in (*finer, limit, nudged, check))
    print(f"{case.name:12s} {len(case.fingers):2d} {_slides(case):6d} |{pairs}")
    order = np.log(one.position_mm / finer[-1].position_mm) / np.log(FINER[-1])
    worth = 100 * NUDGE * one.position_mm / nudged.position_mm
    print(f"{'':15s} closer with MuJoCo's step to the power {order:.2f}; worth {worth:.2g} % of friction")


def _slides(case: Case) -> int:
    """How many spells of sliding there are."""
    moving = np.any(np.diff(_stepped(case, STEP_S), axis=0) != 0.0, axis=1).astype(int)
    return int(np.sum(np.diff(moving, prepend=0) == 1))


def _checked(case: Case) -> FloatArray:
    """Our answer by other means: scipy's integration with events of a lone finger, or half the implicit steps."""
    if case.lone is not None:
        return PlainTrial(case, "DOP853", rtol=1e-9, stop_m_s=1e-7).run()
    return 2.0 * _stepped(case, 0.5 * STEP_S)[-1] - _stepped(case, STEP_S)[-1]


if __name__ == "__main__":
    main()
