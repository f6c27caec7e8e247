from dataclasses import replace

import numpy as np
import pytest
from synthetic import Cameras, _echoes, _ticks

from slidepipe.errors import EstimationError, InputError
from slidepipe.estimation.clock import fit_clock


def exchanges(seed=0, end_s=2.5, **options):
    cameras = Cameras(seed=seed, **options)
    return cameras, _echoes(end_s, np.random.default_rng(seed), cameras)


def test_offset_and_drift_without_jitter():
    cameras, sync = exchanges(latency_jitter_s=0.0, clock_drift_ppm=200.0)
    fit = fit_clock(sync)
    host = np.array([0.1, 1.7, 2.9])
    np.testing.assert_allclose(fit.to_host(_ticks(host, cameras)), host * 1e9, atol=300)
    assert fit.drift_ppm == pytest.approx(-200.0, abs=0.3)
    assert fit.bound_ns == pytest.approx(1e5, rel=0.01)


def test_jitter_stays_within_the_stated_uncertainty():
    errors = []
    for seed in range(200):
        cameras, sync = exchanges(seed=seed)
        fit = fit_clock(sync)
        host_s = fit.reference_ns * 1e-9
        errors.append((fit.to_host(_ticks(np.array([host_s]), cameras))[0] - fit.reference_ns) / fit.sd_ns)
    assert np.mean(np.abs(errors)) < 1.2
    assert np.mean(np.abs(errors) < 2.0) > 0.88
    assert abs(np.mean(errors)) < 0.3


def test_mapped_time_is_good_to_a_tenth_of_a_millisecond():
    for seed in range(20):
        cameras, sync = exchanges(seed=seed)
        host = np.linspace(0.2, 2.9, 7)
        error = fit_clock(sync).to_host(_ticks(host, cameras)) - host * 1e9
        assert np.abs(error).max() < 1.5e5


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: replace(s, ticks=s.ticks[::-1]), "ticks goes back at exchange 1"),
        (lambda s: replace(s, sent_ns=s.sent_ns[::-1]), "sent_ns goes back"),
        (lambda s: replace(s, received_ns=s.sent_ns - 1), "exchange 0 was received before it was sent"),
        (lambda s: replace(s, ticks=s.ticks[:-1]), "of one length"),
        (lambda s: replace(s, ticks_per_s=float("nan")), "ticks_per_s must be a positive number"),
    ],
)
def test_exchanges_that_contradict_themselves(change, message):
    with pytest.raises(InputError, match=message):
        fit_clock(change(exchanges()[1]))


def test_too_few_exchanges():
    sync = exchanges()[1]
    few = replace(sync, sent_ns=sync.sent_ns[:2], ticks=sync.ticks[:2], received_ns=sync.received_ns[:2])
    with pytest.raises(EstimationError, match="at least 3 are needed"):
        fit_clock(few)
