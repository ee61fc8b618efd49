//! A control period of the arm: some steps of its dynamics under one pull, watched for a touch.

use super::clearance::ContactWatch;
use super::dynamics::{ArmState, Dynamics, Pull};
use super::planar_arm::PlanarArm;

impl Dynamics {
    /// Moves `state` on by `steps` steps of `dt` \[s\]; true if the arm touched what `watch` watches, and then
    /// stands there.
    pub fn play(
        &self,
        arm: &PlanarArm,
        state: &mut ArmState,
        watch: &mut ContactWatch,
        pull: Pull,
        (steps, dt): (u32, f64),
    ) -> bool {
        for _ in 0..steps {
            let next = self.step(*state, pull, dt);
            if let Some(share) = watch.touch(arm, state.q, next.q) {
                let q = [0, 1].map(|i| state.q[i] + share * (next.q[i] - state.q[i]));
                *state = ArmState::at_rest(q);
                return true;
            }
            *state = next;
        }
        false
    }
}
