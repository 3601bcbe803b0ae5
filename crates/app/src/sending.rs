//! Sends the history to the databases of `fleet.toml` while a rig runs. The sending threads share only the history
//! file, the view and the alarms with the thread of the rig.

use super::controls::Controls;
use super::order::Files;
use fleet::{Pusher, TargetState};
use machine::station::trouble::Alarm;
use machine::view::FleetView;

/// Starts to send, until the returned value is dropped; returns `None` when `fleet.toml` names no database.
///
/// # Errors
/// Fails for a faulty `fleet.toml`.
pub(super) fn start(files: &Files, controls: &Controls) -> anyhow::Result<Option<Pusher>> {
    let fleet = config::load_fleet(&files.config)?;
    if fleet.targets.is_empty() {
        return Ok(None);
    }
    let (view, alarms) = (controls.view.clone(), controls.fleet.clone());
    let told = move |states: &[TargetState]| {
        let late: Vec<Alarm> = states.iter().filter_map(alarm).collect();
        alarms.send_if_modified(|alarms| {
            let changed = *alarms != late;
            *alarms = late;
            changed
        });
        let fleet: Vec<FleetView> = states.iter().map(shown).collect();
        view.send_if_modified(|view| {
            let changed = view.fleet != fleet;
            view.fleet = fleet;
            changed
        });
    };
    Ok(Some(Pusher::start(
        &fleet,
        files.db.clone(),
        Box::new(told),
    )))
}

/// Returns the alarm about a database that has lacked parts for longer than `alarm_after_s`; `None` for any other.
fn alarm(state: &TargetState) -> Option<Alarm> {
    let late = state.is_late();
    late.then(|| Alarm::fleet_late(&state.url, state.alarm_after_s))
}

fn shown(state: &TargetState) -> FleetView {
    FleetView {
        url: state.url.clone(),
        lag_parts: state.lag_parts,
        lag_s: state.lag_s,
        late: state.is_late(),
        last_error: state.last_error.clone(),
        sent_parts: state.sent_parts,
    }
}
