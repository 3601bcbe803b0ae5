//! Why a part does not pass: a code with its side and detail.
//!
//! Programs compare codes; the history stores them, and JSON carries them as `{"code", "param", "side", "detail", "en",
//! "zh"}`. [`Reason`] prints as the string used in rows, files and the API, for example `operate_voltage_v high`. Only
//! the import of a CSV file reads that string back.

use super::characteristic::Characteristic;
use super::finding::Finding;
use super::verdict::Bin;
use crate::gauge::Side;
use serde::Serialize;
use std::fmt;
use texts::{Lang, Message};
use utoipa::ToSchema;

named! {
    /// What is wrong with the serial number of a part.
    SerialFault {
        /// No reading, or one without a code.
        Missing = "serial_missing",
        /// Another part of the lot has the number.
        Repeated = "serial_repeated",
        /// Two different readings for one part.
        Ambiguous = "serial_ambiguous",
    }
}

/// What a test found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Code {
    /// The value lies outside its limit by more than its uncertainty.
    OutsideLimit(Characteristic),
    /// The value lies within its uncertainty of the limit, even after confirmation measurements.
    NotProven(Characteristic),
    /// No usable value.
    NotMeasured(Characteristic),
    /// The handling or the test of the part was cut off. The detail is the code of an alarm or of an order, which has a
    /// text in the family `interruption`.
    Interrupted,
    /// A line or module failed in the middle of the test; detail: which, and how.
    RigTrouble,
    /// The part cannot be identified, so it is not tested; detail: the readings.
    Serial(SerialFault),
    /// Finding of a test of one kind.
    Finding(Finding),
    /// A text that has no code, because it was imported or written by a version with other codes. The detail is the
    /// text.
    Unclassified,
}

/// Reason why a part does not pass.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reason {
    /// What the test found.
    pub code: Code,
    /// Side of the limit that the reason concerns, if it concerns a limit.
    pub side: Option<Side>,
    /// What the text adds to the code: a figure, a pin, a module; may be empty.
    pub detail: String,
    /// Message of [`Code::RigTrouble`], whose English text is `detail`; `None` for a reason read from a history.
    pub trouble: Option<Box<Message>>,
}

impl Reason {
    /// Returns a reason that has no side and no detail.
    pub fn of(code: Code) -> Self {
        Self::detailed(code, "")
    }

    fn detailed(code: Code, detail: impl Into<String>) -> Self {
        Self {
            code,
            side: None,
            detail: detail.into(),
            trouble: None,
        }
    }

    /// Returns the reason for a value proven outside its limit.
    pub fn outside(characteristic: Characteristic, side: Side) -> Self {
        Self {
            side: Some(side),
            ..Self::of(Code::OutsideLimit(characteristic))
        }
    }

    /// Returns the reason for a value that lies within its uncertainty of the limit.
    pub fn not_proven(characteristic: Characteristic, side: Side) -> Self {
        Self {
            side: Some(side),
            ..Self::of(Code::NotProven(characteristic))
        }
    }

    /// Returns the reason for a part whose handling or test was cut off by `why`, the code of an alarm or an order.
    pub fn interrupted(why: &str) -> Self {
        Self::detailed(Code::Interrupted, why)
    }

    /// Returns the reason for a failed line or module; `why`, of family `detail`, names it.
    pub fn rig_trouble(why: Message) -> Self {
        Self {
            trouble: Some(Box::new(why.clone())),
            ..Self::detailed(Code::RigTrouble, why.say(Lang::En))
        }
    }

    /// Returns the reason for a part that cannot be identified; `read` holds the readings.
    pub fn serial(fault: SerialFault, read: impl Into<String>) -> Self {
        Self::detailed(Code::Serial(fault), read)
    }

    /// Returns the reason for a text without a code.
    pub fn unclassified(text: impl Into<String>) -> Self {
        Self::detailed(Code::Unclassified, text)
    }

    /// Returns the bin to which this reason alone sends a part.
    pub fn bin(&self) -> Bin {
        match self.code {
            Code::OutsideLimit(characteristic) | Code::NotProven(characteristic) => {
                characteristic.bin()
            }
            Code::Finding(finding) => finding.entry().bin.unwrap_or(Bin::RETEST),
            Code::NotMeasured(_)
            | Code::Interrupted
            | Code::RigTrouble
            | Code::Serial(_)
            | Code::Unclassified => Bin::RETEST,
        }
    }

    /// Returns true when the reason proves the part bad.
    pub fn is_failure(&self) -> bool {
        self.bin() != Bin::RETEST
    }

    /// Returns the characteristic that the reason concerns, if it concerns one.
    pub fn characteristic(&self) -> Option<Characteristic> {
        match self.code {
            Code::OutsideLimit(it) | Code::NotProven(it) | Code::NotMeasured(it) => Some(it),
            Code::Finding(finding) => finding.entry().proves.map(|(of, _)| of),
            Code::Interrupted | Code::RigTrouble | Code::Serial(_) | Code::Unclassified => None,
        }
    }

    /// Returns the reason that a history stores under this code name; `None` for an unknown name, or when the code
    /// needs a characteristic and none is given.
    pub fn stored(
        code: &str,
        characteristic: Option<Characteristic>,
        side: Option<Side>,
        detail: &str,
    ) -> Option<Self> {
        Some(Self {
            side,
            ..Self::detailed(Code::from_name(code, characteristic)?, detail)
        })
    }

    /// Reads a text that came without a code; a text that matches no code becomes [`Code::Unclassified`].
    pub fn from_text(text: &str) -> Self {
        let every = Finding::all()
            .map(Self::from)
            .chain([Self::interrupted("")])
            .chain(SerialFault::ALL.iter().map(|it| Self::serial(*it, "")))
            .chain(Self::of_limits(text));
        let found = every.filter_map(|reason| reason.read(text)).next();
        found.unwrap_or_else(|| Self::unclassified(text))
    }

    /// Returns every reason about the limits of the characteristic whose key begins the text.
    fn of_limits(text: &str) -> Vec<Self> {
        let key = text.split(' ').next().unwrap_or_default();
        let Some(characteristic) = Characteristic::from_key(key) else {
            return Vec::new();
        };
        vec![
            Self::outside(characteristic, Side::Low),
            Self::outside(characteristic, Side::High),
            Self::not_proven(characteristic, Side::Low),
            Self::not_proven(characteristic, Side::High),
            Self::of(Code::NotMeasured(characteristic)),
        ]
    }

    /// Returns this reason with the detail that makes it print as `text`; `None` when no detail does.
    fn read(self, text: &str) -> Option<Self> {
        const PLACE: &str = "\0";
        let detailed = |detail: &str| Self {
            detail: detail.to_owned(),
            ..self.clone()
        };
        let row = |detail| detailed(detail).to_string();
        if row("") == text {
            return Some(detailed(""));
        }
        let with_place = row(PLACE);
        let (before, after) = with_place.split_once(PLACE)?;
        let detail = text.strip_prefix(before)?.strip_suffix(after)?;
        Some(detailed(detail))
    }

    /// Returns the message for the reason, whose text omits the name of the characteristic.
    pub fn message(&self) -> Message {
        let param = self.characteristic().map_or("", Characteristic::key);
        let message = Message::new("reason", self.code.name()).with("param", param);
        if let Some(trouble) = &self.trouble {
            return message.with_inner("detail", trouble).case("known");
        }
        let message = message.with("detail", &self.detail);
        match (self.code, self.side) {
            (Code::Finding(_) | Code::Serial(_), _) if self.detail.is_empty() => {
                message.case("any")
            }
            (Code::Interrupted, _) => message.with("interruption", &self.detail),
            (Code::Finding(_), None) => message.with("pins", &self.detail),
            (Code::RigTrouble, _) if self.detail.is_empty() => message,
            (Code::RigTrouble, _) => message.with("said", &self.detail).case("stored"),
            (_, None) => message,
            (Code::OutsideLimit(_) | Code::NotProven(_), Some(side)) => {
                message.case(side.name()).with("side", side)
            }
            (
                Code::NotMeasured(_) | Code::Finding(_) | Code::Serial(_) | Code::Unclassified,
                Some(side),
            ) => message.with("side", side),
        }
    }

    /// Returns the text that follows the name of the characteristic on paper.
    pub fn text(&self, lang: Lang) -> String {
        self.message().say(lang)
    }

    /// Returns the short text for a page: the name of the characteristic, and a word that says what is wrong with it.
    pub fn short(&self, lang: Lang) -> String {
        let message = self.message();
        let said = message.try_attribute(lang, "short");
        let said = said.unwrap_or_else(|| message.say(lang));
        match (self.characteristic(), lang) {
            (None, _) => said,
            (Some(it), Lang::En) => format!("{} {said}", it.name(lang)),
            (Some(it), Lang::Zh) => format!("{}{said}", it.name(lang)),
        }
    }
}

impl Code {
    /// Returns the name in rows and exports.
    pub fn name(self) -> &'static str {
        match self {
            Self::OutsideLimit(_) => "outside_limit",
            Self::NotProven(_) => "not_proven",
            Self::NotMeasured(_) => "not_measured",
            Self::Interrupted => "interrupted",
            Self::RigTrouble => "rig_trouble",
            Self::Serial(fault) => fault.name(),
            Self::Finding(finding) => finding.entry().code,
            Self::Unclassified => "unclassified",
        }
    }

    fn from_name(name: &str, characteristic: Option<Characteristic>) -> Option<Self> {
        match name {
            "outside_limit" => characteristic.map(Self::OutsideLimit),
            "not_proven" => characteristic.map(Self::NotProven),
            "not_measured" => characteristic.map(Self::NotMeasured),
            "interrupted" => Some(Self::Interrupted),
            "rig_trouble" => Some(Self::RigTrouble),
            "unclassified" => Some(Self::Unclassified),
            name => SerialFault::from_name(name).map(Self::Serial).or_else(|| {
                let mut findings = Finding::all();
                let finding = findings.find(|it| it.entry().code == name);
                finding.map(Self::Finding)
            }),
        }
    }
}

impl<F: Into<Finding>> From<F> for Reason {
    fn from(finding: F) -> Self {
        let finding = finding.into();
        Self {
            side: finding.entry().proves.map(|(_, side)| side),
            ..Self::of(Code::Finding(finding))
        }
    }
}

/// JSON form of a [`Reason`].
#[derive(Serialize, ToSchema)]
#[schema(as = Reason)]
struct Shown<'a> {
    /// Code of the reason.
    code: &'a str,
    /// Characteristic that the reason is about; null without one.
    #[schema(value_type = Option<String>)]
    param: Option<Characteristic>,
    /// Side of the limits that the reason is about; null without one.
    side: Option<Side>,
    /// Detail that the text adds to the code, for example pins; may be empty.
    detail: &'a str,
    /// English text.
    en: String,
    /// Chinese text.
    zh: String,
}

impl<'a> From<&'a Reason> for Shown<'a> {
    fn from(reason: &'a Reason) -> Self {
        Self {
            code: reason.code.name(),
            param: reason.characteristic(),
            side: reason.side,
            detail: &reason.detail,
            en: reason.short(Lang::En),
            zh: reason.short(Lang::Zh),
        }
    }
}

texts::json_form!(Reason, Shown);

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let message = self.message();
        let row = message.try_attribute(Lang::En, "row");
        f.write_str(&row.unwrap_or_else(|| message.say(Lang::En)))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::dut::em_relay::{self, Parameter};

    const OPERATE: Characteristic = Characteristic::EmRelay(Parameter::OperateVoltage);

    #[test]
    fn a_reason_prints_as_the_interface_says() {
        let said = [
            (
                Reason::outside(OPERATE, Side::High),
                "operate_voltage_v high",
            ),
            (
                Reason::not_proven(OPERATE, Side::Low),
                "operate_voltage_v low not proven",
            ),
            (
                Reason::of(Code::NotMeasured(OPERATE)),
                "operate_voltage_v not measured",
            ),
            (Reason::interrupted("door_open"), "interrupted: door_open"),
            (
                Reason::serial(SerialFault::Repeated, "S-1"),
                "serial number read again: S-1",
            ),
            (em_relay::Finding::CoilOpen.into(), "coil open"),
            (
                em_relay::Finding::PinOpen.with("COM"),
                "no Kelvin contact at COM: missing pin or dirty probe",
            ),
        ];
        for (reason, text) in said {
            assert_eq!(reason.to_string(), text);
            assert_eq!(Reason::from_text(text), reason);
        }
    }

    #[test]
    fn a_reason_is_the_same_after_it_was_stored() {
        let general = [
            Reason::outside(OPERATE, Side::High),
            Reason::not_proven(OPERATE, Side::Low),
            Reason::of(Code::NotMeasured(OPERATE)),
            Reason::interrupted("door_open"),
            Reason::stored("rig_trouble", None, None, "module 03 silent").unwrap(),
            Reason::serial(SerialFault::Ambiguous, "S-1, S-2"),
            Reason::unclassified("refused by the clerk"),
        ];
        let of_kinds = Finding::all().map(|it| Reason {
            detail: "COM".into(),
            ..it.into()
        });
        for reason in of_kinds.chain(general) {
            let name = reason.code.name();
            let back = Reason::stored(name, reason.characteristic(), reason.side, &reason.detail);
            assert_eq!(back, Some(reason));
        }
        assert_eq!(Reason::stored("outside_limit", None, None, ""), None);
        assert_eq!(Reason::stored("of tomorrow", None, None, ""), None);
    }

    #[test]
    fn every_reason_is_read_back_from_its_row() {
        for bare in Finding::all().map(Reason::from) {
            let has_detail = Reason {
                detail: "COM".into(),
                ..bare.clone()
            };
            let names_it = has_detail.to_string().contains("COM");
            let reason = if names_it && !bare.to_string().contains("COM") {
                has_detail
            } else {
                bare
            };
            assert_eq!(Reason::from_text(&reason.to_string()), reason);
        }
    }

    #[test]
    fn every_reason_has_a_text_in_both_languages() {
        for reason in Finding::all().map(Reason::from) {
            let [en, zh] = Lang::ALL.map(|lang| reason.short(lang));
            assert!(!en.is_empty() && !zh.is_empty() && en != zh, "{reason}");
        }
        let high = Reason::outside(OPERATE, Side::High);
        assert_eq!(high.short(Lang::En), "Operate voltage high");
        assert_eq!(high.short(Lang::Zh), "动作电压偏高");
        assert_eq!(high.text(Lang::Zh), "超出上限");
    }

    #[test]
    fn a_reason_without_detail_leaves_no_gap() {
        let serials = SerialFault::ALL.iter().map(|it| Reason::serial(*it, ""));
        for reason in Finding::all().map(Reason::from).chain(serials) {
            let message = reason.message();
            let (id, case) = (message.id(), message.args().get("case"));
            for lang in Lang::ALL {
                let used = texts::arguments(lang, &id, case);
                let used = used.or_else(|| texts::arguments(lang, &id, None)).unwrap();
                assert!(!used.contains("detail") && !used.contains("pins"), "{id}");
            }
        }
        let pin = Reason::from(em_relay::Finding::PinOpen);
        assert_eq!(pin.short(Lang::Zh), "无开尔文接触：缺引脚或探针脏污");
    }

    #[test]
    fn an_unknown_text_keeps_its_words() {
        let reason = Reason::from_text("refused by the clerk");
        assert_eq!(reason.code, Code::Unclassified);
        assert_eq!(reason.to_string(), "refused by the clerk");
    }
}
