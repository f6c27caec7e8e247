"""The cameras' clock while a trial runs: by the shortest round trip of late, so that a drift does not add up."""

from slidepipe.lab.camera_clock import WINDOW, CameraClock
from slidepipe.lab.protocols import ClockExchange

TICKS_PER_S = 1e7
DRIFT = 50e-6


def exchange(time_ns: int, there_ns: int, back_ns: int) -> ClockExchange:
    ticks = round((time_ns + there_ns) * (1 + DRIFT) * 1e-9 * TICKS_PER_S)
    return ClockExchange(time_ns, ticks, time_ns + there_ns + back_ns)


def test_nothing_is_known_before_the_first_exchange() -> None:
    clock = CameraClock(TICKS_PER_S)
    assert clock.host_ns(0) is None
    assert clock.round_trip_ns is None


def test_the_shortest_round_trip_is_believed() -> None:
    clock = CameraClock(TICKS_PER_S)
    for there_ns, back_ns in ((900_000, 100_000), (100_000, 110_000), (100_000, 2_000_000)):
        clock.take(exchange(10**9, there_ns, back_ns))
    assert clock.round_trip_ns == 210_000
    ticks = round(1.5 * (1 + DRIFT) * TICKS_PER_S)
    assert abs(clock.host_ns(ticks) - 1_500_000_000) <= 5_100 + 0.5e9 * DRIFT


def test_an_old_short_trip_is_forgotten() -> None:
    clock = CameraClock(TICKS_PER_S)
    clock.take(exchange(0, 1_000, 1_000))
    for number in range(1, 10 * WINDOW):
        clock.take(exchange(number * 100_000_000, 50_000, 60_000))
    now_ns = 10 * WINDOW * 100_000_000
    error_ns = clock.host_ns(round(now_ns * (1 + DRIFT) * 1e-9 * TICKS_PER_S)) - now_ns
    assert abs(error_ns) <= 5_100 + WINDOW * 1e8 * DRIFT, "not the drift of the whole trial"
