//! A progress bar on stderr, hidden when stderr is no terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// Template of a progress bar that counts pieces.
pub const PIECES: &str = "{bar:40} {pos}/{len} {per_sec} {eta}";

/// Returns a progress bar for `length` pieces; without a length the bar has no end.
pub fn progress(length: Option<u64>, template: &str) -> ProgressBar {
    let target = match std::io::stderr().is_terminal() {
        true => ProgressDrawTarget::stderr(),
        false => ProgressDrawTarget::hidden(),
    };
    let bar = ProgressBar::with_draw_target(length, target);
    let style = ProgressStyle::with_template(template);
    bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
