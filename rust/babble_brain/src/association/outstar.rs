//! Grossberg's outstar: what an input neuron sends is the mean of what it was paired with.

use super::Association;
use crate::error::{BrainError, check_activity, check_finite, check_length, check_range};

/// Inputs below this send nothing and learn nothing.
const SILENT: f32 = 1e-4;

impl Association {
    /// Learns from m movements in their order by the outstar rule (Grossberg 1968): an input neuron's
    /// weights move towards the output's activity, the less, the more it was used before,
    ///
    /// ```text
    /// u_i ← u_i + g_i,    Δw_ji = (g_i / u_i) (a_j - w_ji)
    /// ```
    ///
    /// so that `w_ji` is the mean of `a_j`, weighted with `g_i`, over all that neuron i was paired with. The
    /// use u is kept in place of the running average ḡ, and ā is not changed. An activity g below 1e-4
    /// counts as zero.
    ///
    /// # Errors
    /// [`BrainError::Length`] or [`BrainError::Activity`] names the slice; nothing is learnt then.
    pub fn learn_outstar(&mut self, g: &[f32], a: &[f32]) -> Result<(), BrainError> {
        let (n_in, n_out) = (self.n_in(), self.n_out());
        let movements = g.len() / n_in;
        check_length("g", movements * n_in, g.len())?;
        check_length("a", movements * n_out, a.len())?;
        check_activity("g", g)?;
        check_activity("a", a)?;
        for (g, a) in g.chunks_exact(n_in).zip(a.chunks_exact(n_out)) {
            let rates = self.use_inputs(g);
            for (w, &a_j) in self.w.chunks_exact_mut(n_in).zip(a) {
                for &(i, rate) in &rates {
                    w[i] += rate * (a_j - w[i]);
                }
            }
        }
        Ok(())
    }

    /// Counts the use of the input neurons that are active, and returns each with its learning rate.
    fn use_inputs(&mut self, g: &[f32]) -> Vec<(usize, f32)> {
        let active = g.iter().enumerate().filter(|&(_, &g_i)| g_i >= SILENT);
        active
            .map(|(i, &g_i)| {
                self.g_mean[i] += g_i;
                (i, g_i / self.g_mean[i])
            })
            .collect()
    }

    /// Sets the use u of the input neurons (`n_in`) that [`learn_outstar`](Self::learn_outstar) keeps.
    ///
    /// # Errors
    /// [`BrainError::Length`], [`BrainError::NotFinite`], or [`BrainError::OutOfRange`] for a use below
    /// zero; nothing is set then.
    pub fn set_use(&mut self, used: &[f32]) -> Result<(), BrainError> {
        check_length("use", self.n_in(), used.len())?;
        check_finite("use", used)?;
        for &u in used {
            check_range(u >= 0.0, "use", u.into(), "0 <= use")?;
        }
        self.g_mean.copy_from_slice(used);
        Ok(())
    }
}
