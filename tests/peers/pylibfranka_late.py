"""Commands that come too late, with pylibfranka: pylibfranka_late.py ADDRESS

The simulator keeps the clock on the wall, since in virtual time no command is late. Commands that are late without intent,
on a busy machine, end the motion in the same way.
"""

from plans import standing_joints
from pylibfranka_reflexes import by_joints, joint_motion, violates
from steps import Session, script

# The robot bridges one command less.
LOST_MAX = 20


def commands_have_to_come_in_time(session):
    def silent(t, state):
        for _ in range(LOST_MAX + 1):
            session.robot.read_once()
        return by_joints(0.0)(t, state)

    return violates(session, joint_motion(session), standing_joints(), silent, ["communication_constraints_violation"])


if __name__ == "__main__":
    script([commands_have_to_come_in_time], Session)
