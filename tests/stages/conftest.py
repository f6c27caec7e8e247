from collections.abc import Callable
from pathlib import Path

import pytest

from slidepipe.artifacts.store import Store
from slidepipe.stages import campaign, estimate, execute, plan, report

EXPERIMENTS = Path(__file__).resolve().parents[2] / "experiments"


@pytest.fixture(scope="session")
def experiments() -> Path:
    return EXPERIMENTS


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "data")


@pytest.fixture(scope="session")
def regrasp(tmp_path_factory: pytest.TempPathFactory) -> tuple[campaign.CampaignResult, Store, list[str]]:
    """The demonstration, run once."""
    store, lines = Store(tmp_path_factory.mktemp("regrasp") / "data"), []
    request = campaign.CampaignRequest(EXPERIMENTS / "regrasp.yaml", store, lines.append)
    return campaign.run(request), store, lines


@pytest.fixture(scope="session")
def regrasp_report(
    regrasp: tuple[campaign.CampaignResult, Store, list[str]], tmp_path_factory: pytest.TempPathFactory
) -> report.ReportResult:
    """The report of the demonstration."""
    path = tmp_path_factory.mktemp("report") / "new" / "report.html"
    return report.run(report.ReportRequest("regrasp", path, regrasp[1]))


@pytest.fixture
def try_out(store: Store) -> Callable[..., tuple[execute.ExecuteResult, estimate.EstimateResult]]:
    """Plan, execute and estimate one trial of an experiment."""

    def attempt(name: str, *overrides: str) -> tuple[execute.ExecuteResult, estimate.EstimateResult]:
        planned = plan.run(plan.PlanRequest(EXPERIMENTS / f"{name}.yaml", store, overrides))
        done = execute.run(execute.ExecuteRequest(planned.run.id, store))
        return done, estimate.run(estimate.EstimateRequest(done.run.id, store))

    return attempt
