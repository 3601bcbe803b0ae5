//! Tests of thresholds and equilibrium states, to twelve digits.

use super::*;
use crate::world::relay::lumped::statics::Balance;

impl Model {
    /// Returns the pickup with rigid contacts: the equilibrium where the break contact opens, a corner of the load.
    fn pickup_rigid(&self) -> Balance {
        let x = (-self.p.d0).max(0.0);
        self.balance(x, self.p.F_r0 + self.p.k_r * x)
    }

    /// Returns the release with rigid contacts and a rigid seat.
    fn release_rigid(&self) -> Balance {
        let p = &self.p;
        let force = (p.k_l * (p.X + p.d0 - p.G)).max(0.0);
        self.balance(p.X, p.F_r0 + p.k_r * p.X + force)
    }

    /// Returns the highest equilibrium voltage after the make contact touches, with rigid contacts; if it exceeds
    /// [`Self::pickup`], the armature stops there on its way.
    fn second_hump(&self) -> Balance {
        let p = &self.p;
        let touch = p.G - p.d0;
        let at = |x: f64| self.balance(x, p.F_r0 + p.k_r * x + self.leaf_on_no(x).0);
        let (mut low, mut high) = (touch.min(p.X), p.X);
        for _ in 0..200 {
            let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
            if at(a).volts < at(b).volts {
                low = a;
            } else {
                high = b;
            }
        }
        at(0.5 * (low + high))
    }

    /// Returns the flux linkage per ampere for small currents with the armature open or seated, H.
    fn inductance(&self, seated: bool) -> f64 {
        let gap = if seated { 0.0 } else { self.p.X };
        self.p.N * self.p.N / self.reluctance(0.0, gap)
    }
}

#[track_caller]
fn same(found: f64, expected: f64) {
    assert!(
        (found / expected - 1.0).abs() < 1e-12,
        "found {found:e}, expected {expected:e}"
    );
}

#[test]
fn thresholds_follow_the_copper_to_twelve_digits() {
    for (celsius, ohm, pickup, release) in [
        (-25.0, 325.436893203883, 6.41393604670281, 1.90615573436326),
        (20.0, 395.339805825243, 7.79163114026666, 2.31559252694725),
        (23.0, 400.0, 7.88347747983758, 2.34288831311952),
        (60.0, 457.47572815534, 9.01624900121231, 2.67953634257747),
        (85.0, 496.31067961165, 9.78163516430333, 2.90700122734635),
    ] {
        let model = relay(&[("T", celsius)]);
        same(model.ohm(), ohm);
        same(model.pickup().volts, pickup);
        same(model.release().volts, release);
        same(model.pickup().amperes, 0.019708693699594);
        same(model.release().amperes, 0.00585722078279879);
    }
}

#[test]
fn rigid_contacts_have_their_folds_in_closed_form() {
    let model = relay(&[]);
    same(model.pickup_rigid().volts, 7.88347744858038);
    same(model.release_rigid().volts, 2.34901300655525);
    assert!((model.pickup().x - 7.99999862679081e-5).abs() < 1e-18);
    assert!((model.release().x - 0.55e-3 - 2.5386456e-13).abs() < 1e-18);
}

#[test]
fn inductance_matches_reference_open_and_seated() {
    let model = relay(&[]);
    same(model.inductance(false), 0.673601548725847);
    same(model.inductance(true), 3.403125);
}

#[test]
fn at_rest_and_sealed_nothing_moves() {
    let model = relay(&[]);
    let rest = model.at_rest(0.0);
    same(rest[X], -2.587970030667148e-8);
    same(rest[Y], -1.1189336366124773e-6);
    let sealed = model.sealed(12.0);
    same(sealed[LAMBDA], 0.06460618569913364);
    same(sealed[X], 0.0005506793340850901);
    same(sealed[Y], 0.0003316324318189272);
    for (state, volts) in [(rest, 0.0), (sealed, 12.0)] {
        let drive = Drive::still(volts);
        let rates = model.rates(0.0, &state, model.modes(&state, &drive), &drive);
        let natural = [1.0, 1.0, 1.0, 1.0, 1.0];
        assert!(
            rates.iter().zip(natural).all(|(r, n)| r.abs() < 1e-8 * n),
            "{rates:?}"
        );
    }
}

#[test]
fn a_hung_armature_has_a_higher_second_hump() {
    let model = relay(&[("k_l", 12_000.0), ("d0", -0.01e-3), ("G", 0.30e-3)]);
    near(Some(model.pickup().volts), 8.4098, 5e-5);
    near(Some(model.second_hump().volts), 9.7065, 5e-5);
    let usual = relay(&[]);
    assert!(usual.second_hump().volts < usual.pickup().volts);
}

#[test]
fn a_stop_returns_the_closed_form_rebound_speed() {
    for (chi_v, expected) in [
        (0.25, 0.85685),
        (1.0, 0.59362),
        (3.0, 0.30690),
        (8.0, 0.12486),
    ] {
        let stop = stop::Stop {
            k: 1e8,
            chi: chi_v / 0.3,
        };
        let flight = |_: f64, s: &State| [0.0, s[V], -stop.push(s[X], s[V]) / 1e-4, 0.0, 0.0];
        let any = dop853::Tolerance { relative: 1.0 };
        let mut s = [0.0, 0.0, 0.3, 0.0, 0.0];
        while s[X] >= 0.0 {
            s = dop853::step(flight, [0.0, 2e-7], &s, &flight(0.0, &s), &any).state;
        }
        near(Some(-s[V] / 0.3), expected, 1e-5);
    }
}
