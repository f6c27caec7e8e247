"""What a motion is executed on: the protocols of arm and cameras, the loop, and the simulated lab."""
