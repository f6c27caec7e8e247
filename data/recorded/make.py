"""Record the trials under data/recorded again: both of the paper's examples, several frictions, noise and dropouts.

Each folder holds ``trial.mcap`` as an execution wrote it and, beside it, what was true: ``truth.yaml`` and the true
poses in ``truth.mcap``. Poses are the same bytes each time; run ids and the code's version are not.
"""

import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.store import Store
from slidepipe.stages import execute, plan
from slidepipe.stages.trial_facts import RECORDING
from slidepipe.stages.trial_files import TRUE_POSES, TRUTH

HERE = Path(__file__).resolve().parent
EXPERIMENTS = HERE.parents[1] / "experiments"


@dataclass(frozen=True, slots=True)
class Recipe:
    """One recorded trial: which experiment, its true friction, its seed, and what else is set."""

    experiment: str
    friction: float
    seed: int
    overrides: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Folder of the trial."""
        return f"{self.experiment.removeprefix('paper_')}-{round(1e4 * self.friction):04d}-seed{self.seed}"


NOISY = ("lab.cameras.position_noise_m=0.0005", "lab.cameras.angle_noise_rad=0.005")
LOSSY = ("lab.cameras.dropout_share=0.1",)
PERFECT = ("lab.tracker.kind=perfect",)

RECIPES = (
    Recipe("paper_linear", 0.3686, 101),
    Recipe("paper_linear", 0.3762, 102),
    Recipe("paper_linear", 0.38, 103),
    Recipe("paper_linear", 0.3876, 104, LOSSY),
    Recipe("paper_linear", 0.3952, 105),
    Recipe("paper_linear", 0.4028, 106, NOISY),
    Recipe("paper_linear", 0.418, 107),
    Recipe("paper_linear", 0.38, 108, PERFECT),
    Recipe("paper_rotational", 0.3648, 201),
    Recipe("paper_rotational", 0.3724, 202),
    Recipe("paper_rotational", 0.38, 203),
    Recipe("paper_rotational", 0.3876, 204, LOSSY),
    Recipe("paper_rotational", 0.3952, 205, NOISY),
    Recipe("paper_rotational", 0.4104, 206),
    Recipe("paper_rotational", 0.38, 207, PERFECT),
)


def record(recipe: Recipe, store: Store) -> None:
    """Plan and execute one trial, and keep its recording with its truth."""
    overrides = (f"lab.friction={recipe.friction}", f"lab.seed={recipe.seed}", *recipe.overrides)
    planned = plan.run(plan.PlanRequest(EXPERIMENTS / f"{recipe.experiment}.yaml", store, overrides))
    done = execute.run(execute.ExecuteRequest(planned.run.id, store))
    folder = HERE / recipe.name
    folder.mkdir(exist_ok=True)
    for role in (RECORDING, TRUTH, TRUE_POSES):
        shutil.copy(done.run.file(role), folder)


def main() -> None:
    """Record every trial of :data:`RECIPES` anew."""
    for old in HERE.glob("*-seed*"):
        shutil.rmtree(old)
    with tempfile.TemporaryDirectory() as directory:
        for recipe in RECIPES:
            record(recipe, Store(Path(directory)))


if __name__ == "__main__":
    main()
