//! Progress bars, on a terminal and for what takes more than a second.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use asperity::stages::Stage;

/// A stage that takes less time has no bar.
const DELAY: Duration = Duration::from_secs(1);

/// How often a spinner is drawn.
const TICK: Duration = Duration::from_millis(500);

/// A line that says what is running and for how long, for work of unknown length.
pub(super) struct Spinner(Option<ProgressBar>);

impl Spinner {
    /// A line on standard error if that is a terminal, else none. It disappears when the value is dropped.
    pub(super) fn new(quiet: bool, message: &str) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self(None);
        }
        let style = ProgressStyle::with_template("{msg}, {elapsed} so far")
            .unwrap_or_else(|_| ProgressStyle::default_spinner());
        let bar = ProgressBar::new_spinner().with_style(style).with_message(message.to_owned());
        bar.enable_steady_tick(TICK);
        Self(Some(bar))
    }

    /// Says something else.
    pub(super) fn say(&self, message: &str) {
        if let Some(bar) = &self.0 {
            bar.set_message(message.to_owned());
        }
    }

    /// Ends the line.
    pub(super) fn finish(self) {}
}

impl Drop for Spinner {
    fn drop(&mut self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

/// A bar for work whose pieces are counted.
pub(super) struct Bar(Option<ProgressBar>);

impl Bar {
    /// A bar on standard error if that is a terminal, else none.
    pub(super) fn new(quiet: bool, what: &str) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self(None);
        }
        let template = "{prefix} [{bar:30}] {pos}/{len}, {elapsed} so far, {eta} to go";
        let style =
            ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        Self(Some(ProgressBar::new(0).with_style(style).with_prefix(what.to_owned())))
    }

    /// Shows how many pieces are done.
    pub(super) fn advance(&self, done: u64, total: u64) {
        if let Some(bar) = &self.0 {
            bar.set_length(total);
            // Threads report in any order.
            bar.set_position(bar.position().max(done));
        }
    }

    /// Ends the bar.
    pub(super) fn finish(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

/// The bar of the stage that is running.
pub(super) struct Progress {
    shown: bool,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    stage: Option<(Stage, Instant)>,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// Bars on standard error if that is a terminal, else none.
    pub(super) fn new(quiet: bool) -> Self {
        let shown = !quiet && std::io::stderr().is_terminal();
        Self { shown, state: Mutex::default() }
    }

    /// A stage begins.
    pub(super) fn start(&self, stage: Stage) {
        if let Ok(mut state) = self.state.lock() {
            *state = State { stage: Some((stage, Instant::now())), bar: None };
        }
    }

    /// Shows how many pieces are done.
    pub(super) fn advance(&self, done: u64, total: u64) {
        let Ok(mut state) = self.state.lock() else { return };
        let Some((stage, start)) = state.stage else { return };
        if !self.shown || start.elapsed() < DELAY {
            return;
        }
        let bar = state.bar.get_or_insert_with(|| {
            let template = "{prefix:<13} [{bar:30}] {pos}/{len}, {elapsed} so far, {eta} to go";
            let style = ProgressStyle::with_template(template)
                .unwrap_or_else(|_| ProgressStyle::default_bar());
            let bar = ProgressBar::new(total).with_style(style).with_elapsed(start.elapsed());
            bar.with_prefix(stage.name())
        });
        bar.set_length(total);
        // Threads report in any order.
        bar.set_position(bar.position().max(done));
    }

    /// The stage has ended.
    pub(super) fn finish(&self) {
        if let Ok(mut state) = self.state.lock()
            && let Some(bar) = std::mem::take(&mut *state).bar
        {
            bar.finish_and_clear();
        }
    }
}
