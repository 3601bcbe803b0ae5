//! A second, independent implementation of the same equations: forces by the sign of the gap, Runge-Kutta with a
//! fixed step, events by linear interpolation. It is slow and simple.

use super::*;

struct Twin(Parameters);

impl Twin {
    fn rates(&self, volts: f64, s: &State) -> State {
        let p = &self.0;
        let [lambda, x, v, y, w] = *s;
        let phi = lambda / p.N;
        let gap = p.X - x;
        let d = p.mu0 * p.A + p.Pf * gap;
        let reluctance = p.Rr + p.Rc0 / (1.0 - phi.abs() / p.phis) + gap / d;
        let ohm = p.R23 * (1.0 + (p.T - 23.0) * p.alpha23);
        let still = lambda * reluctance / p.N.powi(2);
        let stop = |k: f64, chi: f64, depth: f64, speed: f64| match depth > 0.0 {
            true => (k * depth.powf(1.5) * (1.0 + chi * speed)).max(0.0),
            false => 0.0,
        };
        let leaf = p.k_l * (x + p.d0 - y) + p.c_l * (v - w);
        let pull = 0.5 * phi.powi(2) * p.mu0 * p.A / d.powi(2);
        let armature = pull - p.F_r0 - p.k_r * x - leaf - p.c_a * v + stop(p.k_s, p.chi_s, -x, -v)
            - stop(p.k_s, p.chi_s, x - p.X, v);
        let tip = leaf + stop(p.k_c, p.chi_c, -y, -w) - stop(p.k_c, p.chi_c, y - p.G, w);
        let flux = (volts - ohm * still) / (1.0 + ohm * p.k_ec / p.N.powi(2));
        [flux, v, armature / p.m_a, w, tip / p.m_c]
    }

    fn step(&self, volts: f64, s: &State, h: f64) -> State {
        let plus = |k: &State, part: f64| std::array::from_fn(|i| s[i] + part * h * k[i]);
        let k1 = self.rates(volts, s);
        let k2 = self.rates(volts, &plus(&k1, 0.5));
        let k3 = self.rates(volts, &plus(&k2, 0.5));
        let k4 = self.rates(volts, &plus(&k3, 1.0));
        std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    }

    /// Returns the instants at which NO changes after a step to `volts` from rest.
    fn changes_of_no(&self, volts: f64, start: State, end_s: f64, h: f64) -> Vec<f64> {
        let (mut s, mut changes) = (start, Vec::new());
        for i in 0..(end_s / h) as usize {
            let next = self.step(volts, &s, h);
            let (from, to) = (s[Y] - self.0.G, next[Y] - self.0.G);
            if (from > 0.0) != (to > 0.0) {
                changes.push(h * (i as f64 + from / (from - to)));
            }
            s = next;
        }
        changes
    }
}

#[test]
fn a_fixed_step_method_finds_the_same_bounces() {
    for changed in [
        &[][..],
        &[("F_r0", 0.2), ("m_a", 1.2e-3)],
        &[("k_ec", 6000.0), ("chi_c", 1.5), ("T", 40.0)],
    ] {
        let model = relay(changed);
        let start = model.at_rest(0.0);
        let plain = Twin(*model.parameters()).changes_of_no(12.0, start, 0.009, 1e-6);
        let run = from_rest(&model, &step(12.0), 0.009);
        let own: Vec<f64> = run
            .events
            .iter()
            .filter(|e| e.element == Element::No)
            .map(|e| e.t_s)
            .collect();
        assert_eq!(own.len(), plain.len(), "{own:?} {plain:?}");
        assert!(own.len() >= 3, "there is bounce to compare");
        for (at, (one, other)) in own.iter().zip(&plain).enumerate() {
            near(Some(*one), *other, if at == 0 { 1e-9 } else { 3e-8 });
        }
    }
}
