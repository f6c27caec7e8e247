"""Every document that slidepipe writes or reads, by the name of its schema."""

from typing import ClassVar

from slidepipe.artifacts.campaign import CampaignDocument
from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.manifest import Manifest
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.schema import Artifact
from slidepipe.artifacts.trial import TrialDocument, TruthDocument


class StoreDocument(Artifact):
    """What is written as ``store.yaml``: the version of the layout."""

    SCHEMA: ClassVar[str] = "slidepipe.store"


DOCUMENTS: dict[str, type[Artifact]] = {
    model.SCHEMA.removeprefix("slidepipe."): model
    for model in (
        *(Experiment, PlanDocument, TrialDocument, TruthDocument, EstimateDocument, CampaignDocument),
        *(Manifest, StoreDocument),
    )
}
"""By ``experiment``, ``plan`` and so on, in the order in which a campaign meets them."""
