//! A progress bar on standard error, if that is a terminal.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use wellspaced::Control;

/// The bar's length: fractions become whole numbers.
const STEPS: u64 = 1000;

/// A bar that goes away when dropped.
pub struct Bar {
    bar: Option<ProgressBar>,
}

impl Bar {
    /// A bar behind `title`, or nothing when standard error is no terminal.
    pub fn new(title: &str) -> Self {
        if !std::io::stderr().is_terminal() {
            return Bar { bar: None };
        }
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr_with_hz(10));
        if let Ok(style) = ProgressStyle::with_template("{prefix} {bar:30} {msg} [{elapsed}]") {
            bar.set_style(style);
        }
        bar.set_prefix(title.to_owned());
        bar.enable_steady_tick(Duration::from_millis(200));
        Bar { bar: Some(bar) }
    }

    /// A control that moves the bar.
    pub fn control(&self) -> Control {
        let Some(bar) = self.bar.clone() else { return Control::new() };
        Control::with_progress(move |progress| {
            bar.set_position((progress.fraction * STEPS as f64) as u64);
            bar.set_message(format!("{}, {} vertices", progress.stage, progress.vertices));
            true
        })
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
