"""Plan: from an experiment file to its first motion."""

from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.experiment import load_experiment
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.run import Run, outside_input
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.stages.motions import first_plan, resolved
from slidepipe.stages.plan_files import EXPERIMENT, PLAN, Occasion, write_plan

STAGE, STAGE_VERSION = "plan", 3
FIGURE, FIGURE_FILE = "figure", "plan.png"


@dataclass(frozen=True, slots=True)
class PlanRequest:
    """Which experiment to plan; ``overrides`` are ``key.key=value``, ``force`` plans again what was planned before.

    ``figure`` draws the plan, too.
    """

    experiment: Path
    store: Store
    overrides: tuple[str, ...] = ()
    force: bool = False
    figure: bool = False
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class PlanResult:
    """The plan's run and document; ``reused`` where an equal plan was there already."""

    run: Run
    document: PlanDocument
    reused: bool


def run(request: PlanRequest) -> PlanResult:
    """Plan an experiment's first motion.

    Raises
    ------
    InputError
        The experiment file is wrong: one line for each fault.
    InfeasibleError
        A limit is broken: one line for each.
    """
    experiment = load_experiment(request.experiment, request.overrides)
    draft = request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=experiment.name,
        parameters=experiment.model_dump(mode="json") | ({"figure": True} if request.figure else {}),
        inputs=(outside_input(EXPERIMENT, request.experiment),),
        command=request.command,
    )
    known = None if request.force else request.store.find_recipe(draft.recipe)
    if known is not None:
        return PlanResult(known, parse(PlanDocument, load(known.file(PLAN))), reused=True)
    with draft:
        chosen = first_plan(experiment)
        reason = "the planner's choice" if experiment.motion.chosen_by_planner else "the experiment's own motion"
        occasion = Occasion(1, reason, None, experiment.friction, None)
        document = write_plan(draft, chosen, resolved(experiment, chosen), occasion)
        if request.figure:
            # Only then, for matplotlib takes half a second to import.
            from slidepipe.stages.plan_picture import picture_plan  # noqa: PLC0415

            picture_plan(chosen, f"{experiment.name}: {document.objective}", draft.add(FIGURE, FIGURE_FILE))
    return PlanResult(draft.run, document, reused=False)
