//! Results of a transient, derived from its events.

use super::modes::Element;
use super::solver::Event;
use super::{V, W};

/// Results of one transient, seconds and metres per second; `None` for an event that did not happen.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcome {
    /// First opening of NC.
    pub nc_first_open: Option<f64>,
    /// First closing of NC.
    pub nc_first_make: Option<f64>,
    /// First closing of NO.
    pub no_first_make: Option<f64>,
    /// First opening of NO.
    pub no_first_open: Option<f64>,
    /// First arrival at the seat.
    pub seat_first: Option<f64>,
    /// Last change of NO.
    pub no_last_change: Option<f64>,
    /// Last change of NC.
    pub nc_last_change: Option<f64>,
    /// Number of closings of NO.
    pub no_makes: u32,
    /// Number of closings of NC.
    pub nc_makes: u32,
    /// Instant at which the suppression first stops conducting.
    pub coil_blocked_first: Option<f64>,
    /// Speed of the contact at the first closing of NO.
    pub no_first_make_speed: Option<f64>,
    /// Speed of the armature at the first arrival at the seat.
    pub seat_first_speed: Option<f64>,
}

impl Outcome {
    /// Derives the results from a list of events.
    pub fn of(events: &[Event]) -> Self {
        let of = |element: Element| events.iter().filter(move |e| e.element == element);
        let first = |element: Element, on: bool| of(element).find(|e| e.on == on);
        let at = |event: Option<&Event>| event.map(|e| e.t_s);
        let makes = |element: Element| of(element).filter(|e| e.on).count() as u32;
        Self {
            nc_first_open: at(first(Element::Nc, false)),
            nc_first_make: at(first(Element::Nc, true)),
            no_first_make: at(first(Element::No, true)),
            no_first_open: at(first(Element::No, false)),
            seat_first: at(first(Element::Seat, true)),
            no_last_change: at(of(Element::No).next_back()),
            nc_last_change: at(of(Element::Nc).next_back()),
            no_makes: makes(Element::No),
            nc_makes: makes(Element::Nc),
            coil_blocked_first: at(first(Element::CoilBlocked, true)),
            no_first_make_speed: first(Element::No, true).map(|e| e.state[W]),
            seat_first_speed: first(Element::Seat, true).map(|e| e.state[V]),
        }
    }
}
