"""What a motion is executed on: protocols of arm and cameras, the loop, the drivers, and the simulated lab.

Two things differ between a lab in virtual time and a real one: the clock and the transport.
"""
