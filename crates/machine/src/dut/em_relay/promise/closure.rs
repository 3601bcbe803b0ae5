//! Scatter of a contact resistance from closure to closure.

use crate::gauge::evidence::Residuals;

/// Returns the residuals of the closures of one contact against a promised scatter in percent of the resistance; `None`
/// for fewer than two closures. Neglects the noise of a reading, which is a thirtieth of that scatter.
pub fn of_closures(mohm: &[f64], scatter_pct: f64) -> Option<Residuals> {
    let logarithms: Vec<f64> = mohm.iter().map(|it| it.ln()).collect();
    Residuals::about_mean(&logarithms, (scatter_pct / 100.0).powi(2), 0.0)
}
