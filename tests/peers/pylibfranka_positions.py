"""Joint positions by pylibfranka, on the orders of `beside_franka_rs`: pylibfranka_positions.py ADDRESS

It reads orders from the standard input and answers each on the standard output, as `franka_rs` beside it does. Until the
next order it commands the position that it commanded last, unless the robot has stopped itself.

| order | what it does | answer |
|---|---|---|
| | connects, and holds the arm where it is | `ready` |
| `follow N SECONDS`, and N lines of seven joint positions | takes the joints along that path, from where they are, a point per cycle, and watches for that long | `target X Y Z`, then a line `MILLISECOND X Y Z` per cycle, and `done` |
| `end` | ends the motion | `ended` |
"""

import select
import sys

import numpy
from pylibfranka import ControlException, ControllerMode, JointPositions, RealtimeConfig, Robot


class Joints:
    """A motion that continues until it is ended."""

    def __init__(self, address):
        self.robot = Robot(address, RealtimeConfig.kIgnore)
        # Pushes must not trigger a reflex.
        torques, forces = [100.0] * 7, [500.0] * 6
        self.robot.set_collision_behavior(torques, torques, forces, forces)
        self.control = self.robot.start_joint_position_control(ControllerMode.JointImpedance)
        self.state, _ = self.control.readOnce()
        self.position = numpy.array(self.state.q_d)

    def cycle(self, finished=False):
        """Commands the position on the last state. Returns that state and the next one, if there is one."""
        command = JointPositions(self.position.tolist())
        command.motion_finished = finished
        self.control.writeOnce(command)
        if finished:
            return None
        before, (self.state, _) = self.state, self.control.readOnce()
        return before, self.state

    def follow(self, path, seconds):
        """Returns the robot's time and the desired position of the end effector for each state."""
        offset = self.position - path[0]
        begin, desired = self.state.time.to_sec(), []
        while self.state.time.to_sec() < begin + seconds:
            point = path[min(len(desired), len(path) - 1)]
            self.position = point + offset
            before, after = self.cycle()
            desired.append((round(before.time.to_sec() * 1e3), *after.O_T_EE_d[12:15]))
        return desired


def main(address):
    joints = Joints(address)
    print("ready", flush=True)
    moves = True
    while True:
        if moves and not select.select([sys.stdin], [], [], 0)[0]:
            try:
                joints.cycle()
            except ControlException as error:
                print(error, file=sys.stderr)
                moves = False
            continue
        order = sys.stdin.readline().split()
        if order[:1] == ["follow"]:
            points, seconds = int(order[1]), float(order[2])
            path = numpy.array([sys.stdin.readline().split() for _ in range(points)], dtype=float)
            desired = joints.follow(path, seconds)
            print("target", *desired[-1][1:])
            for line in desired:
                print(*line)
            print("done", flush=True)
        elif order == ["end"]:
            if moves:
                joints.cycle(finished=True)
            print("ended", flush=True)
            return
        else:
            sys.exit(f"not an order: {order}")


if __name__ == "__main__":
    main(sys.argv[1])
