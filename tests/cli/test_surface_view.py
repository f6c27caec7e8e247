import json
from pathlib import Path

from cli import samples, surface_samples
from slidepipe.artifacts.store import Store

PRINTED = """\
surface 20261124T093100Z-5vrfacex  block, 50 pushes
support      x mm   y mm     share %
────────────────────────────────────
1, fitted  -20.00   0.00  50.0 ± 3.0
2, fitted  -20.00  10.00  50.0 ± 3.0

mu f_N of all supports        4.46 ± 0.11 N
largest moment over force     39.24 mm
left of the wrenches          1.127 N and 45.58 N mm rms
ellipsoid of the same pushes  4.303 N, rho 41.43 mm

direction of sliding for the measured wrench   median °  nine of ten below °
────────────────────────────────────────────────────────────────────────────
surface of the supports, beside the motion          9.1                 26.0
ellipsoid, beside the motion                       14.0                 26.3
ellipsoid, beside the surface of the supports      11.2                 18.9

data/runs/2026-11-24/20261124T093100Z-5vrfacex/surface.yaml
"""


def test_surface(call, stages) -> None:
    result = call("surface", "pushes.csv", "supports.yaml", "--force")
    assert (result.exit_code, result.stderr, result.stdout) == (0, "", PRINTED)
    (request,) = stages.requests
    assert vars(request) == {
        "pairs": Path("pushes.csv"),
        "supports": Path("supports.yaml"),
        "store": Store(Path("data")),
        "force": True,
        "command": ("slidepipe", "surface", "pushes.csv", "supports.yaml", "--force"),
    }


def test_a_patch_of_many_supports_is_told_by_their_number(call, stages) -> None:
    stages.answers["surface"].document = surface_samples.surface(supports=144, given=True)
    told = call("surface", "pushes.csv", "supports.yaml").stdout
    assert "\n144 supports with given shares\n" in told
    assert "-20.00" not in told


def test_surface_as_one_object(call) -> None:
    told = json.loads(call("surface", "pushes.csv", "supports.yaml", "--json").stdout)
    assert list(told) == ["schema", "run", "directory", "reused", "document"]
    assert (told["schema"], told["document"]["schema"]) == ("slidepipe.surface_result/1", "slidepipe.surface/1")


def test_a_surface_is_shown_again(call, publish) -> None:
    run = samples.run(surface_samples.SURFACE, "surface", outputs=(samples.output("surface", "surface.yaml"),))
    publish(run, surface=surface_samples.surface())
    assert PRINTED in call("show", "@latest:surface").stdout
