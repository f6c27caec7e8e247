"""Every document that slidepipe writes or reads, by the name of its schema."""

from typing import ClassVar

from slidepipe.artifacts.arm_correction import ArmCorrectionDocument
from slidepipe.artifacts.calibration import CalibrationDocument
from slidepipe.artifacts.campaign import CampaignDocument
from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.lab import LabDocument
from slidepipe.artifacts.manifest import Manifest
from slidepipe.artifacts.one_dof import OneDofExperiment, OneDofPlan, OneDofTrials
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.pooled import PooledDocument
from slidepipe.artifacts.repeat import RepeatDocument
from slidepipe.artifacts.schema import Artifact
from slidepipe.artifacts.surface import SupportsDocument, SurfaceDocument
from slidepipe.artifacts.sweep import SweepDocument, SweepTrialDocument
from slidepipe.artifacts.trial import TrialDocument, TruthDocument
from slidepipe.artifacts.why import WhyDocument


class StoreDocument(Artifact):
    """What is written as ``store.yaml``: the version of the layout."""

    SCHEMA: ClassVar[str] = "slidepipe.store"


DOCUMENTS: dict[str, type[Artifact]] = {
    model.SCHEMA.removeprefix("slidepipe."): model
    for model in (
        *(Experiment, PlanDocument, TrialDocument, TruthDocument, EstimateDocument, CampaignDocument),
        *(WhyDocument, ArmCorrectionDocument, RepeatDocument, SweepDocument, SweepTrialDocument),
        *(OneDofExperiment, OneDofPlan, OneDofTrials, PooledDocument, CalibrationDocument),
        *(SupportsDocument, SurfaceDocument, LabDocument, Manifest, StoreDocument),
    )
}
"""By ``experiment``, ``plan`` and so on, in the order in which a campaign meets them."""
