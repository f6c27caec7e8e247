"""The beat that every room keeps."""

TICK_S = 0.002
"""Period of the vendor's control loop: the spacing of every reference, s."""
