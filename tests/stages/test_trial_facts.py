"""What a recording tells at once."""

from pathlib import Path

import numpy as np

from slidepipe.artifacts import topics
from slidepipe.artifacts.recording import read_recording
from slidepipe.artifacts.recording_writer import RecordingWriter
from slidepipe.stages.trial_facts import followed


def test_ticks_of_which_one_half_is_missing_are_left_out(tmp_path: Path) -> None:
    """A recorder that is killed between the two messages of a tick leaves the first of them alone."""
    path, still = tmp_path / "a.mcap", np.zeros(7)
    with RecordingWriter(path, {"run": "a"}) as writer:
        for topic, stamps in ((topics.COMMANDED, (10, 12, 14, 16)), (topics.MEASURED, (12, 14, 18))):
            for stamp in stamps:
                writer.joints(
                    topic,
                    stamp_ns=stamp,
                    log_ns=stamp,
                    position_rad=still + stamp,
                    velocity_rad_s=still,
                    effort_n_m=still,
                )
    arm = followed(read_recording(path))
    assert arm.commanded.stamp_ns.tolist() == arm.measured.stamp_ns.tolist() == [12, 14]
    np.testing.assert_array_equal(arm.commanded.position_rad, arm.measured.position_rad)
