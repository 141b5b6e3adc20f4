"""A relay between a client and a robot, in a separate process, which records what the client does not show.

The client's state has neither the mode of the motion generator nor the mode of the controller. The relay passes everything
on as it is, except the port to which states go, and notes the modes of the states and the motions requested.
"""

import multiprocessing
import select
import socket
import struct

PORT = 1337
# Of protocol 10, both directions of the stream: command, command id, size of the message.
HEADER = struct.Struct("<III")
CONNECT, MOVE = 0, 1
# Version and port, in Connect; controller and generator, in Move.
CONNECT_REQUEST, MOVE_REQUEST = struct.Struct("<HH"), struct.Struct("<II")
# Offsets of the modes in a state of protocol 10.
GENERATOR_MODE, CONTROLLER_MODE, ROBOT_MODE = 1288, 1289, 1372
STATE_SIZE = 1377


class Tap:
    """The relay to the robot at `robot`, which listens at `here` from when this is made."""

    def __init__(self, robot, here):
        self.notes, notes = multiprocessing.Pipe()
        listener = socket.create_server((here, PORT))
        relay = multiprocessing.Process(target=serve, args=(listener, robot, here, notes, self.notes), daemon=True)
        relay.start()
        listener.close()

    def seen(self):
        """The modes of the states since the last call, each when it changed, and the motions requested.

        The modes belong to robot, motion generator and controller; a motion is its controller and generator.
        """
        self.notes.send(None)
        return self.notes.recv()


def serve(listener, robot, here, notes, far_end):
    """Serves one client after the other, until the process that made the relay has ended."""
    far_end.close()  # With this copy open, its end would not show in `notes`.
    while select.select([listener, notes], [], [])[0] == [listener]:
        client, _ = listener.accept()
        Relay(client, robot, here, notes).run()


class Relay:
    def __init__(self, client, robot, here, notes):
        self.client, self.notes = client, notes
        self.robot = socket.create_connection((robot, PORT))
        for stream in (self.client, self.robot):
            stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        # The robot sends states to the host that its stream comes from.
        self.states = udp_socket(self.robot.getsockname()[0])
        self.commands = udp_socket(here)
        self.client_address, self.robot_address = None, None
        self.requests = b""
        self.modes, self.motions = [], []

    def run(self):
        """Passes on what comes until one of the ends is closed."""
        actions = {
            self.states: self.pass_states,
            self.commands: self.pass_commands,
            self.client: self.pass_requests,
            self.robot: self.pass_replies,
            self.notes: self.tell,
        }
        while True:
            for source in select.select(list(actions), [], [])[0]:
                try:
                    actions[source]()
                except (EOFError, OSError):
                    return

    def pass_states(self):
        state, self.robot_address = self.states.recvfrom(2 * STATE_SIZE)
        self.commands.sendto(state, self.client_address)
        modes = (state[ROBOT_MODE], state[GENERATOR_MODE], state[CONTROLLER_MODE])
        if self.modes[-1:] != [modes]:
            self.modes.append(modes)

    def pass_commands(self):
        command = self.commands.recv(2 * STATE_SIZE)
        self.states.sendto(command, self.robot_address)

    def pass_requests(self):
        self.requests += received(self.client)
        while len(self.requests) >= HEADER.size:
            command, _, size = HEADER.unpack_from(self.requests)
            if len(self.requests) < size:
                return
            message, self.requests = bytearray(self.requests[:size]), self.requests[size:]
            if command == CONNECT:
                version, port = CONNECT_REQUEST.unpack_from(message, HEADER.size)
                self.client_address = (self.client.getpeername()[0], port)
                CONNECT_REQUEST.pack_into(message, HEADER.size, version, self.states.getsockname()[1])
            elif command == MOVE:
                self.motions.append(MOVE_REQUEST.unpack_from(message, HEADER.size))
            self.robot.sendall(message)

    def pass_replies(self):
        self.client.sendall(received(self.robot))

    def tell(self):
        self.notes.recv()
        self.notes.send((self.modes, self.motions))
        self.modes, self.motions = self.modes[-1:], []


def udp_socket(host):
    end = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    end.bind((host, 0))
    return end


def received(stream):
    """Receives some bytes; the end of the stream is an error."""
    data = stream.recv(65536)
    if not data:
        raise EOFError
    return data
