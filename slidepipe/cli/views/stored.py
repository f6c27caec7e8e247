"""The documents of a run that was published before, shown as the stage that wrote them shows them."""

from typing import TYPE_CHECKING, Any

from rich.console import RenderableType

from slidepipe.artifacts.arm_correction import ArmCorrectionDocument
from slidepipe.artifacts.calibration import CalibrationDocument
from slidepipe.artifacts.campaign import CampaignDocument
from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.one_dof import OneDofPlan, OneDofTrials
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.pooled import PooledDocument
from slidepipe.artifacts.repeat import RepeatDocument
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import Artifact, parse
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.surface import SurfaceDocument
from slidepipe.artifacts.sweep import SweepDocument, SweepTrialDocument
from slidepipe.artifacts.trial import TrialDocument, TruthDocument
from slidepipe.artifacts.why import WhyDocument
from slidepipe.cli.views.calibration import calibration_view
from slidepipe.cli.views.campaign import campaign_view
from slidepipe.cli.views.estimate import estimate_view
from slidepipe.cli.views.one_dof import one_dof_plan_view, one_dof_trials_view
from slidepipe.cli.views.plan import plan_view
from slidepipe.cli.views.pooled import pooled_view
from slidepipe.cli.views.repeat import repeat_view
from slidepipe.cli.views.surface import surface_view
from slidepipe.cli.views.sweep import sweep_trial_view, sweep_view
from slidepipe.cli.views.trial import trial_view
from slidepipe.cli.views.why import arm_view, why_view
from slidepipe.errors import InputError, NotFoundError, StoreError

if TYPE_CHECKING:
    from collections.abc import Callable

MODELS: dict[str, type[Artifact]] = {
    "plan.yaml": PlanDocument,
    "trial.yaml": TrialDocument,
    "truth.yaml": TruthDocument,
    "estimate.yaml": EstimateDocument,
    "pooled.yaml": PooledDocument,
    "campaign.yaml": CampaignDocument,
    "why.yaml": WhyDocument,
    "arm.yaml": ArmCorrectionDocument,
    "repeat.yaml": RepeatDocument,
    "sweep.yaml": SweepDocument,
    "sweep_trial.yaml": SweepTrialDocument,
    "one_dof_plan.yaml": OneDofPlan,
    "one_dof_trials.yaml": OneDofTrials,
    "calibration.yaml": CalibrationDocument,
    "surface.yaml": SurfaceDocument,
}
"""What the stages write, by the name of the file."""


def read_documents(run: Run) -> dict[str, Artifact]:
    """Read what a run's stage wrote, by the name of the file.

    Raises
    ------
    StoreError
        A file that the manifest names is missing or damaged.
    NewerSchemaError
        A newer slidepipe wrote it.
    """
    names = [output.file for output in run.manifest.outputs]
    try:
        return {name: parse(model, load(run.directory / name)) for name, model in MODELS.items() if name in names}
    except (InputError, NotFoundError) as error:
        raise StoreError(str(error)) from None


def stage_view(documents: dict[str, Artifact], run: Run, *, all_limits: bool) -> list[RenderableType]:
    """View of each document; nothing where the stage wrote none, as a failed one may."""
    truth = documents.get("truth.yaml")
    views: dict[type[Artifact], Callable[[Any], list[RenderableType]]] = {
        PlanDocument: lambda one: plan_view(one, run, all_limits=all_limits),
        TrialDocument: lambda one: trial_view(one, truth if isinstance(truth, TruthDocument) else None, run),
        EstimateDocument: lambda one: estimate_view(one, run),
        PooledDocument: lambda one: pooled_view(one, run),
        CalibrationDocument: lambda one: calibration_view(one, run),
        SurfaceDocument: lambda one: surface_view(one, run),
        CampaignDocument: lambda one: campaign_view(one, run),
        RepeatDocument: lambda one: repeat_view(one, run),
        SweepDocument: lambda one: sweep_view(one, run),
        SweepTrialDocument: sweep_trial_view,
        WhyDocument: why_view,
        ArmCorrectionDocument: arm_view,
        OneDofPlan: lambda one: one_dof_plan_view(one, run),
        OneDofTrials: lambda one: one_dof_trials_view(one, run),
    }
    shown = [views[type(document)](document) for document in documents.values() if type(document) in views]
    return [part for view in shown for part in ("", *view)]
