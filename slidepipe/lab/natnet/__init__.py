"""NatNet, the protocol of OptiTrack's Motive: a codec without I/O, a client and a server.

``codec`` turns datagrams into the records of ``messages`` and ``models`` and back, for the versions 2.5 to 4.1.
``client`` is the lab's motion capture over UDP, ``server`` plays Motive.
"""
