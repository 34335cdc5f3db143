# SPDX-License-Identifier: Apache-2.0
"""The hostile client of the soak: nonsense, floods of commands and of subscriptions, connections that come and go, until it is ended."""
import itertools
import random
import sys
import time

import zmq

from dts.v1 import control_pb2


def main(control: str, data: str) -> None:
    context: "zmq.Context[zmq.Socket[bytes]]" = zmq.Context()
    chance = random.Random(7)
    for turn in itertools.count():
        with context.socket(zmq.DEALER) as commands, context.socket(zmq.SUB) as subscriber:
            for socket in (commands, subscriber):
                socket.linger = 0
            commands.connect(control)
            subscriber.connect(data)
            for number in range(200):
                mark = control_pb2.Request(request_id=f"{turn}.{number}", tare=control_pb2.TareRequest(rig="nobody"))
                for bytes_ in (mark.SerializeToString(), chance.randbytes(300)):
                    try:
                        commands.send_multipart([b"", bytes_], zmq.NOBLOCK)
                    except zmq.Again:
                        pass  # its answers are never read, so its queue fills
                subscriber.subscribe(f"{turn}.{number}".ljust(400, "x"))
            time.sleep(0.2)


if __name__ == "__main__":
    main(*sys.argv[1:])
