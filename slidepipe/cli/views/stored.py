"""The documents of a run that was published before, shown as the stage that wrote them shows them."""

from rich.console import RenderableType

from slidepipe.artifacts.calibration import CalibrationDocument
from slidepipe.artifacts.campaign import CampaignDocument
from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.pooled import PooledDocument
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import Artifact, parse
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.surface import SurfaceDocument
from slidepipe.artifacts.trial import TrialDocument, TruthDocument
from slidepipe.cli.views.calibration import calibration_view
from slidepipe.cli.views.campaign import campaign_view
from slidepipe.cli.views.estimate import estimate_view
from slidepipe.cli.views.plan import plan_view
from slidepipe.cli.views.pooled import pooled_view
from slidepipe.cli.views.surface import surface_view
from slidepipe.cli.views.trial import trial_view
from slidepipe.errors import InputError, NotFoundError, StoreError

MODELS: dict[str, type[Artifact]] = {
    "plan.yaml": PlanDocument,
    "trial.yaml": TrialDocument,
    "truth.yaml": TruthDocument,
    "estimate.yaml": EstimateDocument,
    "pooled.yaml": PooledDocument,
    "campaign.yaml": CampaignDocument,
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
    parts: list[RenderableType] = []
    for document in documents.values():
        if isinstance(document, PlanDocument):
            parts += ["", *plan_view(document, run, all_limits=all_limits)]
        elif isinstance(document, TrialDocument):
            truth = documents.get("truth.yaml")
            parts += ["", *trial_view(document, truth if isinstance(truth, TruthDocument) else None, run)]
        elif isinstance(document, EstimateDocument):
            parts += ["", *estimate_view(document, run)]
        elif isinstance(document, PooledDocument):
            parts += ["", *pooled_view(document, run)]
        elif isinstance(document, CalibrationDocument):
            parts += ["", *calibration_view(document, run)]
        elif isinstance(document, SurfaceDocument):
            parts += ["", *surface_view(document, run)]
        elif isinstance(document, CampaignDocument):
            parts += ["", *campaign_view(document, run)]
    return parts
