"""Names of the topics of a recording."""

HAND = "/mocap/hand"
OBJECT = "/mocap/object"
FRAME = "/mocap/frame"
CLOCK = "/mocap/clock"
COMMANDED = "/joints/commanded"
MEASURED = "/joints/measured"
EVENTS = "/events"
