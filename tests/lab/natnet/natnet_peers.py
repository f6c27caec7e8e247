"""NatNet clients that others wrote, each as a script: prints the bodies of the frames that it was given, and goes.

Called with the client's name, the transport, the server's ports and how many frames to wait for. What the clients print
themselves goes to stderr.
"""

# ruff: noqa: PLC0415, T201  # a script: each client is imported where it is asked for

import contextlib
import json
import os
import sys
import threading
import time

PATIENCE_S = 20.0
Bodies = dict[str, list[float]]
"""Position and quaternion x y z w of each body, by its number."""


def natnet(multicast: bool, command_port: int, data_port: int, count: int) -> list[Bodies]:
    from natnet import NatNetClient

    heard: list[Bodies] = []
    client = NatNetClient(use_multicast=multicast, command_port=command_port, data_port=data_port)
    client.on_data_frame_received_event.handlers.append(
        lambda frame: heard.append({str(one.id_num): [*one.pos, *one.rot] for one in frame.rigid_bodies})
    )
    with client:
        client.request_modeldef()
        client.run_async()
        wait(lambda: len(heard) >= count)
        client.stop_async()
    return heard


def natnetsdk(multicast: bool, command_port: int, data_port: int, count: int) -> list[Bodies]:
    from natnetsdk.NatNetClient import NatNetClient

    heard: list[Bodies] = [{}]
    client = NatNetClient()
    client.set_use_multicast(multicast)
    client.command_port, client.data_port = command_port, data_port
    client.rigid_body_listener = lambda number, at, turn: heard[-1].update({str(number): [*at, *turn]})
    client.new_frame_listener = lambda _frame: heard.append({})
    client.run()
    wait(lambda: len(heard) > count)
    threading.Thread(target=client.shutdown, daemon=True).start()
    return heard[:-1]


def motioncapture(multicast: bool, command_port: int, data_port: int, count: int) -> list[Bodies]:  # noqa: ARG001
    import motioncapture as peer

    heard: list[Bodies] = []
    client = peer.connect("optitrack", {"hostname": "127.0.0.1", "port_command": str(command_port)})
    for _ in range(count):
        client.waitForNextFrame()
        heard.append({})
        for name, one in client.rigidBodies.items():
            turn = one.rotation
            heard[-1][name] = [float(number) for number in (*one.position, turn.x, turn.y, turn.z, turn.w)]
    return heard


def wait(done) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not done() and time.monotonic() < deadline:
        time.sleep(0.01)


if __name__ == "__main__":
    name, transport, command_port, data_port, count = sys.argv[1:]
    with contextlib.redirect_stdout(sys.stderr):
        told = globals()[name](transport == "multicast", int(command_port), int(data_port), int(count))
    print(json.dumps(told[-int(count) :]), flush=True)
    os._exit(0)  # their threads do not always end
