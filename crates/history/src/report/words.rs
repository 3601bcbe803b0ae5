//! The words of the pages in both languages, in one place.

use machine::dut::reason::Code;
use machine::dut::words::Words;
use machine::dut::{Characteristic, Reason};
use machine::gauge::Side;
use serde::Deserialize;

/// Language of a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Language {
    /// English.
    En,
    /// Simplified Chinese.
    Zh,
}

impl Language {
    /// The word of this language.
    pub fn of<'a>(self, en: &'a str, zh: &'a str) -> &'a str {
        match self {
            Self::En => en,
            Self::Zh => zh,
        }
    }

    /// The text of this language.
    pub fn say(self, words: Words) -> &'static str {
        self.of(words.en, words.zh)
    }

    /// Tag for the `lang` of a page.
    pub fn tag(self) -> &'static str {
        match self {
            Self::En => "en",
            Self::Zh => "zh-CN",
        }
    }

    /// Name of a parameter with its unit; the key itself for one that only a recipe knows.
    pub fn parameter(self, key: &str) -> String {
        let Some(known) = Characteristic::from_key(key) else {
            return key.to_owned();
        };
        let name = self.of(known.definition().name_en, known.definition().name_zh);
        format!("{name} / {}", known.unit().sign())
    }

    /// Why a part did not pass; what has no words of its own stands there as the history says it.
    pub fn reason(self, reason: &Reason) -> String {
        let side = reason.side;
        let said = match (reason.code, reason.code.words()) {
            (_, Some(words)) => self.say(words).to_owned(),
            (Code::OutsideLimit(_), None) => self.outside(side).to_owned(),
            (Code::NotProven(_), None) => self.not_proven(side).to_owned(),
            (Code::NotMeasured(_), None) => self.of("not measured", "未测得").to_owned(),
            (
                Code::EmRelay(_)
                | Code::Resistor(_)
                | Code::Interrupted
                | Code::RigTrouble
                | Code::Unclassified,
                None,
            ) => reason.to_string(),
        };
        match reason.characteristic() {
            None => said,
            Some(it) => format!("{}{}{said}", self.parameter(it.key()), self.of(": ", "：")),
        }
    }

    fn outside(self, side: Option<Side>) -> &'static str {
        match side {
            Some(Side::High) => self.of("above the upper limit", "超出上限"),
            Some(Side::Low) => self.of("below the lower limit", "低于下限"),
            None => self.of("outside its limits", "超出限值"),
        }
    }

    fn not_proven(self, side: Option<Side>) -> &'static str {
        match side {
            Some(Side::High) => self.of("not proven below the upper limit", "未能证明低于上限"),
            Some(Side::Low) => self.of("not proven above the lower limit", "未能证明高于下限"),
            None => self.of("not proven", "未能证明"),
        }
    }

    /// Name of a verdict.
    pub fn verdict(self, verdict: &str) -> &str {
        match verdict {
            "pass" => self.of("pass", "合格"),
            "fail" => self.of("fail", "不合格"),
            "void" => self.of("not judged", "未判定"),
            "unjudged" => self.of("imported without verdict", "导入未判定"),
            other => other,
        }
    }

    /// Name of a bin.
    pub fn bin(self, bin: &str) -> &str {
        match bin {
            "pass" => self.of("pass", "合格"),
            "coil" => self.of("coil", "线圈"),
            "voltage" => self.of("voltage", "电压"),
            "time" => self.of("time", "时间"),
            "contact" => self.of("contact", "触点"),
            "retest" => self.of("retest", "复测"),
            other => other,
        }
    }

    /// What no test of this rig covers; stands on every page that says a part is good.
    pub fn not_tested(self) -> &'static str {
        match self {
            Self::En => {
                "Not tested: insulation resistance, dielectric strength, electrical and mechanical endurance."
            }
            Self::Zh => "未测项目：绝缘电阻、介质耐压、电气寿命与机械寿命。",
        }
    }
}

/// A name whose unit stays beside it where the line breaks.
pub(super) fn unbroken(name: &str) -> String {
    name.replace(" / ", "\u{a0}/\u{a0}")
}

/// Five significant digits without trailing zeros; a dash for nothing.
pub(super) fn figure(value: Option<f64>) -> String {
    let Some(value) = value.filter(|it| it.is_finite()) else {
        return "–".to_owned();
    };
    if value == 0.0 {
        return "0".to_owned();
    }
    let before = value.abs().log10().floor();
    if !(-4.0..7.0).contains(&before) {
        return format!("{value:.3e}");
    }
    let decimals = (4.0 - before).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A share as percent with two decimals; a dash for nothing.
pub(super) fn percent(part: u64, of: u64) -> String {
    if of == 0 {
        return "–".to_owned();
    }
    format!("{:.2} %", 100.0 * part as f64 / of as f64)
}

/// Seconds as hours, minutes and seconds.
pub(super) fn span(seconds: f64) -> String {
    let whole = seconds.round().max(0.0) as u64;
    format!("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
}
