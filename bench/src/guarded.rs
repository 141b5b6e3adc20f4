//! The cycle of target control with every guard on, for every kind of goal. A session is simulated
//! in episodes from seeds. An episode is deterministic: cycle number n always has the same history,
//! so it can be measured again in the same state.

use std::cell::RefCell;
use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::time::Instant;

use super::{Benchmark, Statistic, Subject};
use franka_lockstep::{Guarded, Part, Workload};
use franka_rt::session::Backend;

/// Benchmarks of all kinds of goals mixed, of each kind, and of the longest cycle, as first
/// measured and measured again.
pub fn all() -> Vec<Benchmark> {
    let survey = Rc::new(RefCell::new(Survey::default()));
    let again = survey.clone();
    let mut benchmarks = vec![
        sampled(
            "rt.cycle_guarded_ns",
            Part::Answer,
            &Workload::ALL,
            &[Statistic::P50, Statistic::P99],
        ),
        sampled(
            "rt.prepare_guarded_ns",
            Part::Preparation,
            &Workload::ALL,
            &[Statistic::P50, Statistic::P99],
        ),
        Benchmark {
            key: "rt.cycle_guarded_ns",
            statistics: &[Statistic::Max],
            round: Box::new(move || again.borrow_mut().measure_again()),
        },
        Benchmark {
            key: "rt.cycle_guarded_once_ns",
            statistics: &[Statistic::Max],
            round: Box::new(move || vec![survey.borrow_mut().longest()]),
        },
    ];
    let kinds: [(_, &'static [Workload]); 5] = [
        ("rt.cycle_poses_ns", &[Workload::Poses]),
        ("rt.cycle_joints_ns", &[Workload::Joints]),
        ("rt.cycle_chunks_ns", &[Workload::Chunks]),
        ("rt.cycle_guide_ns", &[Workload::Guide]),
        ("rt.cycle_setpoints_ns", &[Workload::RobotController]),
    ];
    benchmarks.extend(
        kinds
            .into_iter()
            .map(|(key, workloads)| sampled(key, Part::Answer, workloads, &[Statistic::P50])),
    );
    benchmarks
}

/// Subjects for counting instructions: the mix, one millisecond of each kind of goal in turn, of
/// which only the answer counts; and the whole cycle of each back end, including the work before
/// its state.
pub fn subjects() -> Vec<Subject> {
    let backends = BACKENDS.iter().map(|&(key, backend)| whole(key, backend));
    [mix()].into_iter().chain(backends).collect()
}

/// The whole work between a state and its command, on the way to joint positions and poses: the
/// prepared step for the state, and the answer.
fn whole(key: &'static str, backend: Backend) -> Subject {
    let mut arm: Option<Guarded> = None;
    Subject {
        key,
        within: &[
            "*lockstep*DriverStack*answer*",
            "*lockstep*DriverStack*prepare*",
        ],
        call: Box::new(move || {
            arm.get_or_insert_with(|| Guarded::with_backend(backend, SEED))
                .tick_around(|_, work| work());
        }),
    }
}

fn mix() -> Subject {
    let mut arms: Option<Vec<Guarded>> = None;
    let mut turn = 0;
    let call = move || {
        let begin = || {
            Workload::ALL
                .map(|workload| Guarded::new(workload, SEED))
                .into()
        };
        let arms = arms.get_or_insert_with(begin);
        let arm = turn % arms.len();
        turn += 1;
        arms[arm].tick_around(|_, work| work());
    };
    Subject {
        key: "rt.cycle_guarded_ns",
        within: &["*lockstep*DriverStack*answer*"],
        call: Box::new(call),
    }
}

/// Returns samples of a part of the cycle, from one episode of each of these kinds per round.
fn sampled(
    key: &'static str,
    part: Part,
    workloads: &'static [Workload],
    statistics: &'static [Statistic],
) -> Benchmark {
    let mut seed = SEED;
    Benchmark {
        key,
        statistics,
        round: Box::new(move || {
            seed += 1;
            let mut samples = Vec::with_capacity(workloads.len() * EPISODE);
            for &workload in workloads {
                run(Episode { workload, seed }, EPISODE, part, |_, took| {
                    samples.push(took);
                });
            }
            samples
        }),
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Episode {
    workload: Workload,
    seed: u64,
}

/// Runs `cycles` cycles of an episode, and passes the number of each, and the nanoseconds of this
/// part of it, to `each`.
fn run(episode: Episode, cycles: usize, timed: Part, mut each: impl FnMut(usize, u64)) {
    let mut arm = Guarded::new(episode.workload, episode.seed);
    let mut cycle = 0;
    while cycle < cycles {
        arm.tick_around(|part, work| {
            let start = Instant::now();
            work();
            if part == timed {
                let took = start.elapsed().as_nanos();
                each(cycle, u64::try_from(took).unwrap_or(u64::MAX));
                cycle += 1;
            }
        });
    }
}

/// The longest of 10⁶ cycles.
#[derive(Debug, Default)]
struct Survey {
    /// The first measured times.
    longest: u64,
    /// The shortest time so far of each suspect, by episode and cycle number.
    suspects: BTreeMap<Episode, BTreeMap<usize, u64>>,
}

impl Survey {
    /// Returns the longest time of any cycle, each measured once.
    fn longest(&mut self) -> u64 {
        self.survey();
        self.longest
    }

    /// Runs the episodes of the suspects again, and returns the shortest time of each.
    fn measure_again(&mut self) -> Vec<u64> {
        self.survey();
        for (episode, suspects) in &mut self.suspects {
            let last = suspects.keys().next_back().copied().unwrap_or(0);
            run(*episode, last + 1, Part::Answer, |cycle, took| {
                if let Some(shortest) = suspects.get_mut(&cycle) {
                    *shortest = took.min(*shortest);
                }
            });
        }
        let all = self.suspects.values().flat_map(BTreeMap::values);
        all.copied().collect()
    }

    /// Measures all cycles, in each episode more than once, so that few become suspects only
    /// because of an interruption.
    fn survey(&mut self) {
        if !self.suspects.is_empty() {
            return;
        }
        let mut suspects: Vec<(u64, Episode, usize)> = Vec::new();
        let mut shortest = vec![0; EPISODE];
        for seed in 0..SEEDS {
            for workload in Workload::ALL {
                let episode = Episode { workload, seed };
                run(episode, EPISODE, Part::Answer, |cycle, took| {
                    self.longest = self.longest.max(took);
                    shortest[cycle] = took;
                });
                for _ in 1..SWEEPS {
                    run(episode, EPISODE, Part::Answer, |cycle, took| {
                        shortest[cycle] = took.min(shortest[cycle]);
                    });
                }
                let all = shortest.iter().enumerate();
                suspects.extend(all.map(|(cycle, &took)| (took, episode, cycle)));
                suspects.sort_by_key(|&(took, ..)| Reverse(took));
                suspects.truncate(SUSPECTS);
            }
        }
        for (took, episode, cycle) in suspects {
            self.suspects
                .entry(episode)
                .or_default()
                .insert(cycle, took);
        }
    }
}

/// Every back end.
const BACKENDS: [(&str, Backend); 9] = {
    let [jq, jdq, jposes, jtwists, cq, cdq, cposes, ctwists] = Backend::ROBOT_CONTROLLERS;
    [
        ("rt.whole_torques", Backend::Torques),
        ("rt.whole_joint_positions", jq),
        ("rt.whole_joint_velocities", jdq),
        ("rt.whole_joint_poses", jposes),
        ("rt.whole_joint_twists", jtwists),
        ("rt.whole_cartesian_positions", cq),
        ("rt.whole_cartesian_velocities", cdq),
        ("rt.whole_cartesian_poses", cposes),
        ("rt.whole_cartesian_twists", ctwists),
    ]
};

const SEED: u64 = 100;

/// Number of cycles of an episode: ten seconds. Tests run a short round of each benchmark and
/// ignore its values.
const EPISODE: usize = if cfg!(debug_assertions) { 200 } else { 10_000 };

/// Number of episodes of each kind of goal, 10⁶ cycles in total.
const SEEDS: u64 = if cfg!(debug_assertions) { 1 } else { 20 };

const SWEEPS: usize = 3;
const SUSPECTS: usize = 20;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_episode_is_deterministic() {
        for workload in Workload::ALL {
            let commanded = || {
                let mut arm = Guarded::new(workload, 3);
                (0..1000)
                    .map(|_| {
                        arm.tick_around(|_, work| work());
                        let record = &arm.lockstep.client.record;
                        (record.tau_c, record.q_ref, record.bindings)
                    })
                    .collect::<Vec<_>>()
            };
            assert_eq!(commanded(), commanded(), "{workload:?}");
        }
    }
}
