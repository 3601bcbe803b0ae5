//! The verdict of a part from its results, and its bin.
//!
//! A part with several failures goes to the worst of their bins, in the order that its kind declares.

use super::Kind;
use super::characteristic::Characteristic;
use super::reason::{Code, Reason};
use super::record::Stop;
use crate::gauge::Judgement;
pub use crate::rig::bin::Bin;

/// Returns the rank of a bin within its kind, 0 for the worst; `usize::MAX` for a bin of no kind.
fn rank(bin: Bin) -> usize {
    let of_kind = |kind: Kind| kind.definition().bins.iter().position(|it| *it == bin);
    Kind::ALL
        .into_iter()
        .find_map(of_kind)
        .unwrap_or(usize::MAX)
}

/// The conclusion of a test about its part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// Every value is proven to lie within its limits.
    Pass,
    /// The part is bad, for at least one reason, worst first.
    Fail(Vec<Reason>),
    /// The part is not judged, for these reasons.
    Void(Vec<Reason>),
}

impl Verdict {
    /// Returns the verdict of a part whose test ended early for `reason` and which failed for `others` too; the worst
    /// bin comes first.
    pub fn failed(reason: Reason, mut others: Vec<Reason>) -> Self {
        others.push(reason);
        others.sort_by_key(|reason| rank(reason.bin()));
        Self::Fail(others)
    }

    /// Returns the verdict of a part of which `expected` had to be measured; the caller has already repeated
    /// conditional results. A proven failure outweighs a void: the part is bad whatever else could not be measured.
    pub fn of(expected: &[Characteristic], judged: &[(Characteristic, Judgement)]) -> Self {
        let mut failed: Vec<Reason> = judged
            .iter()
            .filter_map(|(characteristic, judgement)| match judgement {
                Judgement::Fail(side) => Some(Reason::outside(*characteristic, *side)),
                Judgement::Conditional(side) => Some(Reason::not_proven(*characteristic, *side)),
                Judgement::Pass | Judgement::Void => None,
            })
            .collect();
        if !failed.is_empty() {
            failed.sort_by_key(|reason| rank(reason.bin()));
            return Self::Fail(failed);
        }
        let passes = |it: &&Characteristic| judged.contains(&(**it, Judgement::Pass));
        let missing: Vec<Reason> = expected
            .iter()
            .filter(|it| !passes(it))
            .map(|it| Reason::of(Code::NotMeasured(*it)))
            .collect();
        if missing.is_empty() {
            Self::Pass
        } else {
            Self::Void(missing)
        }
    }

    /// Returns the verdict of a part; `stop` is why its test ended early, `None` when it did not. A proven failure
    /// outweighs every stop except trouble of the rig.
    pub fn after(
        stop: Option<&Stop>,
        expected: &[Characteristic],
        judged: Vec<(Characteristic, Judgement)>,
    ) -> Self {
        let Some(stop) = stop else {
            return Verdict::of(expected, &judged);
        };
        let proven = |(_, judgement): &(Characteristic, Judgement)| match judgement {
            Judgement::Fail(_) => true,
            Judgement::Pass | Judgement::Conditional(_) | Judgement::Void => false,
        };
        let failed: Vec<_> = judged.into_iter().filter(proven).collect();
        match (stop, Verdict::of(expected, &failed)) {
            (Stop::Trouble(why), _) => Self::Void(vec![why.clone()]),
            (Stop::Fail(reason), Self::Fail(reasons)) => Verdict::failed(reason.clone(), reasons),
            (Stop::Fail(reason), Verdict::Pass | Self::Void(_)) => Self::Fail(vec![reason.clone()]),
            (Stop::Void(_), Self::Fail(reasons)) => Self::Fail(reasons),
            (Stop::Void(why), Verdict::Pass | Self::Void(_)) => Self::Void(vec![why.clone()]),
        }
    }

    /// Returns `pass`, `fail` or `void`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail(_) => "fail",
            Self::Void(_) => "void",
        }
    }

    /// Returns the bin to which the part goes.
    pub fn bin(&self) -> Bin {
        match self {
            Self::Pass => Bin::PASS,
            Self::Fail(reasons) => reasons
                .iter()
                .map(Reason::bin)
                .min_by_key(|bin| rank(*bin))
                .unwrap_or(Bin::RETEST),
            Self::Void(_) => Bin::RETEST,
        }
    }

    /// Returns why the part does not pass; empty for a pass.
    pub fn reasons(&self) -> &[Reason] {
        match self {
            Self::Pass => &[],
            Self::Fail(reasons) | Self::Void(reasons) => reasons,
        }
    }

    /// Returns the reasons as texts for rows and for `run --json`.
    pub fn texts(&self) -> Vec<String> {
        self.reasons().iter().map(Reason::to_string).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dut::em_relay::{Parameter, bins};
    use crate::gauge::Side;

    fn all() -> Vec<Characteristic> {
        Parameter::ALL.map(Characteristic::EmRelay).to_vec()
    }

    #[test]
    fn a_part_passes_only_when_every_result_passes() {
        let judged: Vec<_> = all().into_iter().map(|it| (it, Judgement::Pass)).collect();
        assert_eq!(Verdict::of(&all(), &judged), Verdict::Pass);
        assert_eq!(Verdict::of(&all(), &judged[1..]).bin(), Bin::RETEST);
    }

    #[test]
    fn several_failures_go_to_coil_contact_voltage_time() {
        let failed = [
            Parameter::OperateTime,
            Parameter::OperateVoltage,
            Parameter::ContactResistanceNo,
        ]
        .map(|it| (Characteristic::EmRelay(it), Judgement::Fail(Side::High)));
        assert_eq!(Verdict::of(&all(), &failed).bin(), bins::CONTACT);
        assert_eq!(Verdict::of(&all(), &failed[..2]).bin(), bins::VOLTAGE);
    }
}
