//! Chunks of a session: how they begin, continue and are returned.

use franka_model::Model;

use super::goals::Bearing;
use super::{GoalStage, RunningSession, Standing};
use crate::session::aim::Aim;
use crate::session::chunk::ChunkReader;
use crate::session::course::Course;
use crate::session::{OnArrival, Target};

impl RunningSession {
    /// Begins a newer chunk of the goal, if there is one. After a chunk that has ended, continues
    /// to rest.
    pub(super) fn follow_chunks(&mut self, model: &Model, chunks: &mut ChunkReader, now: u64) {
        if let Some(retired) = self.route.retired_chunk.take() {
            retired.end(chunks, now);
        }
        let gone = self.stage.lets_go();
        // A cancelled goal follows no chunk, even if it was cancelled before the session saw it.
        let follows =
            self.goal.along_path || self.goal.on_arrival == OnArrival::Hold || self.is_given_up();
        if gone || !follows || self.is_given_up_for_good() {
            chunks.discard(self.goal.id);
            return;
        }
        let over = match &self.route.course {
            Course::Chunk(chunk) => chunk.is_over(now),
            _ => true,
        };
        if let Some(chunk) = chunks.poll(self.goal.id, now, over) {
            let target = chunk.target();
            self.aim = Bearing::Followed(target);
            let aim = Aim {
                target,
                ..self.aim(model, now)
            };
            let before = self
                .route
                .follow(model, &self.ee, &self.reference, &aim, chunk, now);
            if let Some(before) = before {
                before.end(chunks, now);
            }
            // Only a held goal can fall silent. It is then held again until a newer goal arrives.
            if self.is_given_up() {
                self.standing = Standing::InForce;
                self.goal.on_arrival = OnArrival::Hold;
            }
            self.heard = now;
            self.stage = GoalStage::UnderWay;
            self.is_refined = false;
        } else if over && let Course::Chunk(chunk) = &self.route.course {
            let target = chunk.target();
            self.turn_to(target);
            self.route.chunk_end = Some(target);
        }
    }

    /// Returns the target at which the reference will stop.
    pub(super) fn heading(&self) -> Target {
        match &self.route.course {
            Course::Chunk(chunk) => chunk.target(),
            _ => self.route.chunk_end.unwrap_or(self.goal.target),
        }
    }
}
