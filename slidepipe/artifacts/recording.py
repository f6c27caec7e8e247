"""Recordings: MCAP files of protobuf messages, with foxglove schemas where one fits.

They open in Foxglove as they are. :class:`RecordingWriter` writes one message by message and :func:`write_series` whole
series; :func:`read_recording` reads a sound file back, and says of a damaged one where it is and what can be saved.
"""

from slidepipe.artifacts.recording_reader import Event, PlanarSeries, Recording, read_recording
from slidepipe.artifacts.recording_series import Series, write_series
from slidepipe.artifacts.recording_writer import RecordingWriter

__all__ = ["Event", "PlanarSeries", "Recording", "RecordingWriter", "Series", "read_recording", "write_series"]
