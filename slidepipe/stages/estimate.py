"""Estimate: what a recording tells of the slide, the final grip and the friction."""

from dataclasses import dataclass

from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.recording_reader import PlanarSeries
from slidepipe.artifacts.recording_series import Series, write_series
from slidepipe.artifacts.recording_writer import RecordingWriter
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.estimation.estimate import Estimate
from slidepipe.estimation.smoothing import SmoothedSeries
from slidepipe.stages.calibration_files import CALIBRATION, read_calibration
from slidepipe.stages.estimate_document import SMOOTHED_FILE, estimate_document
from slidepipe.stages.recorded_estimate import RecordedEstimate, estimate_recording
from slidepipe.stages.trial_source import trial_source

STAGE, STAGE_VERSION = "estimate", 3
ESTIMATE, SMOOTHED, FIGURE = "estimate", "smoothed", "figure"
"""Roles of an estimate's files."""
FIGURE_FILE = "estimate.png"
SMOOTHED_HAND, SMOOTHED_OBJECT, SMOOTHED_RELATIVE = "/smoothed/hand", "/smoothed/object", "/smoothed/relative"


@dataclass(frozen=True, slots=True)
class EstimateRequest:
    """Which trial to estimate: a run, or the path of a recording; ``force`` estimates it again, ``figure`` draws it.

    ``calibration`` is the run that says where cameras and markers are; without it, they are where they should be.
    ``overrides`` set keys of the experiment's ``estimation``.
    """

    trial: str
    store: Store
    force: bool = False
    figure: bool = False
    calibration: str | None = None
    overrides: tuple[str, ...] = ()
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class EstimateResult:
    """The estimate's run and document; ``reused`` where an equal estimate was there already."""

    run: Run
    document: EstimateDocument
    reused: bool


def run(request: EstimateRequest) -> EstimateResult:
    """Estimate a trial from its recording.

    Raises
    ------
    NotFoundError
        There is no such run, or it holds no recording.
    InputError
        The recording is damaged or contradicts itself.
    EstimationError
        It is too short or too empty for anything. A lost object is no error: the document says so.
    """
    source = trial_source(request.trial, request.store)
    calibration = None if request.calibration is None else request.store.get(request.calibration)
    draft = request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=source.experiment,
        parameters=_parameters(request),
        inputs=(source.input, *((calibration.input(CALIBRATION),) if calibration else ())),
        command=request.command,
    )
    known = None if request.force else request.store.find_recipe(draft.recipe)
    if known is not None:
        return EstimateResult(known, parse(EstimateDocument, load(known.file(ESTIMATE))), reused=True)
    # Before anything is made: a recording that tells nothing leaves nothing.
    found = estimate_recording(source.path, read_calibration(calibration) if calibration else None, request.overrides)
    document = estimate_document(found, source.trial, calibration.id if calibration else None)
    with draft:
        _write(draft, found, document)
        if request.figure:
            _draw(draft, found, source.trial)
    return EstimateResult(draft.run, document, reused=False)


def _parameters(request: EstimateRequest) -> dict[str, object]:
    figure: dict[str, object] = {"figure": True} if request.figure else {}
    return figure | ({"overrides": list(request.overrides)} if request.overrides else {})


def _write(draft: Draft, found: RecordedEstimate, document: EstimateDocument) -> None:
    draft.add(ESTIMATE, "estimate.yaml").write_text(dump_model(document), encoding="utf-8")
    told = found.estimate
    topics = {SMOOTHED_HAND: told.hand, SMOOTHED_OBJECT: told.object, SMOOTHED_RELATIVE: told.relative}
    with RecordingWriter(draft.add(SMOOTHED, SMOOTHED_FILE), {"run": draft.run_id, "trial": document.trial}) as writer:
        write_series(writer, Series(planar={topic: _series(told, series) for topic, series in topics.items()}))
    if document.friction is not None:
        kappa = document.friction.kappa_m_s2
        draft.report("kappa", kappa.value, std=kappa.std, unit="m/s^2")
    if document.lost is not None:
        draft.state = RunState.LOST


def _draw(draft: Draft, found: RecordedEstimate, trial: str) -> None:
    # Only those who ask for a picture wait for matplotlib.
    from slidepipe.figures.estimated import draw_estimate  # noqa: PLC0415
    from slidepipe.stages.estimate_picture import estimate_picture  # noqa: PLC0415

    picture = estimate_picture(
        found.estimate,
        f"Estimate of trial {trial}: {found.experiment.name}",
        start_ns=found.start_ns,
        stop_s=found.plan.phases[-1].stop_s,
        believed=found.plan.believed.kappa_m_s2,
    )
    draw_estimate(picture, draft.add(FIGURE, FIGURE_FILE))


def _series(told: Estimate, smoothed: SmoothedSeries) -> PlanarSeries:
    return PlanarSeries(told.tracks.stamp_ns, smoothed.pose, smoothed.velocity, smoothed.pose_sd)
