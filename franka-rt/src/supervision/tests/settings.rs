//! Settings of a program. They are sent on every connection before a motion begins there.

use super::*;

const STIFF: Request = Request::SetJointImpedance([3000.0; 7]);
const SOFT: Request = Request::SetJointImpedance([300.0; 7]);
const FREE: Request = Request::SetGuidingMode {
    guiding_mode: [true; 6],
    nullspace: true,
};
const CONFIGURING: Condition = Condition::Unready(Unready::Configuring);
const NOT_SET: Unready = Unready::NotConfigured(Command::SetJointImpedance);

fn waiting() -> Supervised {
    let policy = without_chance().recover(100, WINDOW);
    Supervised::ready(policy.motions_wait(MS(60_000)))
}

fn answer(robot: &mut Supervised, id: SettingId, answer: &Answer) {
    let now = MS(robot.now);
    robot.after(|it| it.on_set(id, answer, now));
}

fn set(robot: &mut Supervised, request: Request, with: &Answer) {
    let id = robot.supervision.declare(request);
    answer(robot, id, with);
}

fn reconnect(robot: &mut Supervised) {
    robot.pass(2000);
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    assert!(robot.connect());
}

/// Returns the number of times that the supervision asked to send settings.
fn configures(robot: &mut Supervised) -> usize {
    let is = |output: &mut Output| matches!(output, Output::Configure);
    robot.asked.extract_if(.., is).count()
}

fn next(robot: &mut Supervised) -> Option<(SettingId, Request)> {
    let now = MS(robot.now);
    robot.after(|it| it.next_setting(now))
}

fn again(robot: &mut Supervised, request: Request, with: Answer) {
    let (id, wanted) = next(robot).expect("there is one");
    assert_eq!(wanted, request);
    robot.after(|it| it.on_set_again(id, with));
}

fn refusal() -> Answer {
    let text = String::from("got 3000, expected 1000");
    Answer::Refused { text }
}

fn unknown() -> Answer {
    let text = String::from("no answer");
    Answer::Unknown { text }
}

#[test]
fn motion_waits_until_settings_are_made_again() {
    let mut robot = waiting();
    set(&mut robot, STIFF, &Answer::Taken);
    set(&mut robot, FREE, &Answer::Taken);
    assert_eq!(robot.condition(), Condition::Ready, "they hold");
    assert_eq!(configures(&mut robot), 0);
    robot.lose(CloseReason::ClosedByPeer);
    assert!(matches!(robot.submit(1), Admission::Wait));
    robot.release();
    assert!(robot.connect());
    assert_eq!(configures(&mut robot), 1);
    assert_eq!(robot.condition(), CONFIGURING);
    again(&mut robot, STIFF, Answer::Taken);
    again(&mut robot, FREE, Answer::Taken);
    assert_eq!(robot.condition(), CONFIGURING);
    assert_eq!(next(&mut robot), None);
    assert_eq!(robot.motions(), [(1, None)]);
    assert_eq!(robot.condition(), Condition::Ready);
}

#[test]
fn settings_are_made_again_after_the_recovery_from_a_reflex() {
    let mut robot = waiting();
    set(&mut robot, STIFF, &Answer::Taken);
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    robot.state.errors = COLLISION.into();
    robot.state.robot_mode = RobotMode::Reflex;
    assert!(robot.connect());
    assert_eq!(robot.recoveries(), [1]);
    assert_eq!(configures(&mut robot), 0);
    robot.answers(1, Ok(()));
    robot.recovers();
    assert_eq!(configures(&mut robot), 1);
    assert_eq!(robot.condition(), CONFIGURING);
}

#[test]
fn stop_during_the_configuring_takes_back_the_motion_that_waits() {
    let mut robot = waiting();
    set(&mut robot, STIFF, &Answer::Taken);
    reconnect(&mut robot);
    assert!(matches!(robot.submit(1), Admission::Wait));
    robot.after(Supervision::stop);
    assert_eq!(robot.motions(), [(1, Some(MotionError::Stopped))]);
    let now = MS(robot.now);
    robot.after(|it| it.latch_stop(now));
    again(&mut robot, STIFF, Answer::Taken);
    assert_eq!(next(&mut robot), None);
    let latched = Condition::Unready(Unready::StopLatched);
    assert_eq!(robot.condition(), latched);
    robot.after(|it| it.release_stop(now));
    assert_eq!(robot.condition(), Condition::Ready);
    assert!(robot.motions().is_empty());
}

#[test]
fn setting_that_is_not_taken_again_refuses_motions() {
    for failure in [refusal(), unknown()] {
        let mut robot = waiting();
        set(&mut robot, STIFF, &Answer::Taken);
        set(&mut robot, FREE, &Answer::Taken);
        reconnect(&mut robot);
        assert!(matches!(robot.submit(1), Admission::Wait));
        configures(&mut robot);
        again(&mut robot, STIFF, failure);
        again(&mut robot, FREE, Answer::Taken);
        assert_eq!(next(&mut robot), None);
        let refused = not_ready(NOT_SET, 0);
        assert_eq!(robot.motions(), [(1, Some(refused.clone()))]);
        assert_eq!(robot.condition(), Condition::Unready(NOT_SET));
        assert!(matches!(robot.submit(2), Admission::Refuse(error) if error == refused));
        let told = robot.told.iter().filter(|kind| {
            matches!(kind, EventKind::NotConfigured { command, text }
                if *command == Command::SetJointImpedance && !text.is_empty())
        });
        assert_eq!(told.count(), 1);
        // The setting is not repeated all the time, only when the robot becomes idle again.
        robot.pass(10_000);
        robot.shows(RobotMode::Idle);
        assert_eq!(configures(&mut robot), 0);
        robot.shows(RobotMode::UserStopped);
        robot.shows(RobotMode::Idle);
        assert_eq!(configures(&mut robot), 1);
        again(&mut robot, STIFF, refusal());
        assert_eq!(next(&mut robot), None);
        // A refused value changes nothing; an accepted value does.
        set(&mut robot, SOFT, &refusal());
        assert_eq!(robot.condition(), Condition::Unready(NOT_SET));
        set(&mut robot, SOFT, &Answer::Taken);
        assert!(matches!(robot.submit(3), Admission::Begin));
        assert_eq!(configures(&mut robot), 0);
    }
}

#[test]
fn robot_held_otherwise_gets_no_motion_before_its_settings() {
    let mut robot = waiting();
    set(&mut robot, STIFF, &Answer::Taken);
    robot.lose(CloseReason::ClosedByPeer);
    robot.release();
    for mode in [RobotMode::UserStopped, RobotMode::Guiding, RobotMode::Other] {
        robot.state.robot_mode = mode;
        assert!(robot.connect());
        // The robot may be idle before it receives the motion.
        assert!(matches!(robot.submit(1), Admission::Refuse(_)), "{mode}");
        robot.lose(CloseReason::ClosedByPeer);
        robot.release();
        robot.pass(2000);
    }
}

#[test]
fn settings_that_failed_in_a_stop_are_made_once_it_is_over() {
    let mut robot = waiting();
    set(&mut robot, STIFF, &Answer::Taken);
    reconnect(&mut robot);
    configures(&mut robot);
    let (id, _) = next(&mut robot).expect("there is one");
    robot.shows(RobotMode::UserStopped);
    // The answer comes later than the state.
    robot.shows(RobotMode::Idle);
    robot.after(|it| it.on_set_again(id, refusal()));
    assert_eq!(next(&mut robot), None);
    assert_eq!(configures(&mut robot), 1);
    assert_eq!(robot.condition(), CONFIGURING);
    again(&mut robot, STIFF, Answer::Taken);
    assert_eq!(next(&mut robot), None);
    assert_eq!(robot.condition(), Condition::Ready);
}

#[test]
fn answer_of_a_connection_before_says_nothing_of_the_newest() {
    let mut robot = waiting();
    let id = robot.supervision.declare(STIFF);
    reconnect(&mut robot);
    assert_eq!(configures(&mut robot), 1);
    answer(&mut robot, id, &Answer::Taken);
    assert_eq!(robot.condition(), CONFIGURING);
    again(&mut robot, STIFF, Answer::Taken);
    assert_eq!(next(&mut robot), None);
    assert_eq!(robot.condition(), Condition::Ready);
}

#[test]
fn newest_value_counts_unless_it_is_refused() {
    let mut robot = waiting();
    set(&mut robot, STIFF, &Answer::Taken);
    set(&mut robot, SOFT, &Answer::Taken);
    set(&mut robot, STIFF, &refusal());
    // If the first value is refused, nothing counts as set.
    set(&mut robot, FREE, &refusal());
    assert_eq!(robot.condition(), Condition::Ready);
    reconnect(&mut robot);
    again(&mut robot, SOFT, Answer::Taken);
    assert_eq!(next(&mut robot), None);
    // A setting without an answer is sent again at once, because it is unknown if the robot has it.
    configures(&mut robot);
    set(&mut robot, STIFF, &unknown());
    assert_eq!(robot.condition(), CONFIGURING);
    assert_eq!(configures(&mut robot), 1);
    again(&mut robot, STIFF, Answer::Taken);
    assert_eq!(next(&mut robot), None);
    assert_eq!(robot.condition(), Condition::Ready);
}

#[test]
fn answers_of_settings_sent_together_count_each_for_its_own() {
    let of = |values: [&Answer; 3], order: [usize; 3]| {
        let mut robot = waiting();
        let requests = [1, 2, 3].map(|it| Request::SetJointImpedance([f64::from(it); 7]));
        let ids = requests.map(|request| robot.supervision.declare(request));
        for place in order {
            answer(&mut robot, ids[place], values[place]);
        }
        assert_eq!(robot.condition(), Condition::Ready);
        reconnect(&mut robot);
        match next(&mut robot) {
            Some((_, Request::SetJointImpedance(newest))) => Some(newest[0]),
            _ => None,
        }
    };
    let (taken, refused) = (&Answer::Taken, &refusal());
    for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0], [0, 2, 1]] {
        assert_eq!(of([taken, taken, taken], order), Some(3.0));
        assert_eq!(of([taken, taken, refused], order), Some(2.0));
        assert_eq!(of([taken, refused, refused], order), Some(1.0));
        assert_eq!(of([refused, taken, refused], order), Some(2.0));
        assert_eq!(of([refused, refused, refused], order), None);
    }
}

#[test]
fn setting_of_the_program_is_awaited_before_motions_begin() {
    for (answered, newest) in [(Answer::Taken, SOFT), (refusal(), STIFF)] {
        let mut robot = waiting();
        set(&mut robot, STIFF, &Answer::Taken);
        set(&mut robot, FREE, &Answer::Taken);
        reconnect(&mut robot);
        assert_eq!(configures(&mut robot), 1);
        // The setting is sent while the other settings are sent again.
        let id = robot.supervision.declare(SOFT);
        again(&mut robot, FREE, Answer::Taken);
        assert_eq!(next(&mut robot), None);
        assert_eq!(robot.condition(), CONFIGURING);
        assert_eq!(configures(&mut robot), 0);
        answer(&mut robot, id, &answered);
        assert_eq!(configures(&mut robot), 1);
        if newest == STIFF {
            again(&mut robot, STIFF, Answer::Taken);
        }
        assert_eq!(next(&mut robot), None);
        assert_eq!(robot.condition(), Condition::Ready);
    }
}

#[test]
fn setting_that_states_no_longer_show_refuses_motions() {
    let text = String::from("got 0 kg, expected 0.5 kg");
    let other = Answer::NotShown { text };
    // If a robot rounds, its states have never shown the setting.
    for (before, now) in [
        (&Answer::Taken, Condition::Unready(NOT_SET)),
        (&other, Condition::Ready),
    ] {
        let mut robot = waiting();
        set(&mut robot, STIFF, before);
        reconnect(&mut robot);
        again(&mut robot, STIFF, other.clone());
        assert_eq!(next(&mut robot), None);
        assert_eq!(robot.condition(), now);
    }
}

#[test]
fn robot_that_is_only_watched_is_not_configured() {
    let mut robot = Supervised::connected(None);
    set(&mut robot, STIFF, &unknown());
    assert_eq!(configures(&mut robot), 0);
    assert!(matches!(robot.submit(1), Admission::Begin));
}
