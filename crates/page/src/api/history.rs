//! The routes of the history; what their members mean stands in [`crate`]'s file about them, too.

use super::{HTML, JSON, Member, Offer, may, must};
use crate::history::{self, export, paper, rejudge};

const LOT: Member = may("lot", "Name of the lot.");
const RUN: Member = may("run", "Number of the run within its lot.");
const RECIPE: Member = may("recipe", "Name of the recipe.");
const SINCE: Member = may("since", "Not before, RFC 3339.");
const UNTIL: Member = may("until", "Before, RFC 3339.");
const VERDICT: Member = may("verdict", "`pass`, `fail`, `void`, `unjudged`.");
const BIN: Member = may("bin", "Bin that the verdict asks for.");
const KIND: Member = may("kind", "`lot` (without it), `golden`, `all`.");
const SUSPECT: Member = may(
    "suspect",
    "`true`: only parts between a passed reference check and a failed one.",
);
const PARAM: Member = may("param", "Parameter key with its unit, as in an export.");
const MIN: Member = may("min", "Least value of `param`.");
const MAX: Member = may("max", "Largest value of `param`.");
const LIMIT: Member = may("limit", "So many at most.");
const OFFSET: Member = may("offset", "So many left out in front.");
const LANG: Member = may("lang", "`zh` (without it) or `en`.");
const SUBGROUP: Member = may("subgroup", "Parts of a subgroup, 1 to 10; 1 without it.");
const RULES: Member = may("rules", "`nelson` (without it) or `western-electric`.");
const LAST: Member = may("last", "Only the last so many points; 200 without it.");

const RUNS: [Member; 3] = [LOT, RUN, RECIPE];
const PAGE: [Member; 2] = [LIMIT, OFFSET];
const FILTER: [Member; 9] = [LOT, RUN, RECIPE, SINCE, UNTIL, VERDICT, BIN, KIND, SUSPECT];
const RANGE: [Member; 3] = [PARAM, MIN, MAX];
const CHART: [Member; 3] = [SUBGROUP, RULES, LAST];

pub(super) fn offers() -> Vec<Offer> {
    let mut offers = read();
    offers.extend(printed());
    offers
}

fn read() -> Vec<Offer> {
    let about_one = [must("param", PARAM.about)];
    vec![
        Offer::get(
            "/api/history/list",
            JSON,
            "Runs of lots with their counts.",
            history::list,
        )
        .with(&RUNS),
        Offer::get(
            "/api/history/show",
            JSON,
            "That part of every run, down to the raw replies.",
            history::show,
        )
        .with(&[
            must("lot", LOT.about),
            must("seq", "Number of the part."),
            RUN,
            KIND,
        ]),
        Offer::get(
            "/api/history/query",
            JSON,
            "Parts that the filter leaves.",
            history::query,
        )
        .with(&FILTER)
        .with(&RANGE)
        .with(&PAGE),
        Offer::get(
            "/api/history/count",
            JSON,
            "How many `query` would give.",
            history::count,
        )
        .with(&FILTER)
        .with(&RANGE),
        Offer::get(
            "/api/history/yield",
            JSON,
            "Verdicts of all production parts in the span.",
            history::yields,
        )
        .with(&[SINCE, UNTIL]),
        Offer::get(
            "/api/history/stats",
            JSON,
            "Statistics of one parameter.",
            history::stats,
        )
        .with(&FILTER)
        .with(&about_one),
        Offer::get(
            "/api/history/histogram",
            JSON,
            "Counts in classes of equal width.",
            history::classes,
        )
        .with(&FILTER)
        .with(&about_one),
        Offer::get("/api/history/spc", JSON, "Control charts.", history::spc)
            .with(&FILTER)
            .with(&[PARAM])
            .with(&CHART),
        Offer::get(
            "/api/history/alarms",
            JSON,
            "Alarms in order of time.",
            history::alarms,
        )
        .with(&RUNS)
        .with(&[SINCE, UNTIL])
        .with(&PAGE),
        Offer::get(
            "/api/history/rejudge",
            JSON,
            "What that recipe would have said of every part of the lot; the summary comes last. Nothing is written.",
            rejudge::rejudge,
        )
        .with(&[
            must("lot", LOT.about),
            must("recipe", "Name of a recipe of the plant."),
            RUN,
            may("changed", "`true`: only parts whose verdict changes."),
        ]),
        Offer::get(
            "/api/history/orders",
            JSON,
            "The audit: who ordered what, and whether it was taken.",
            history::orders,
        )
        .with(&RUNS)
        .with(&[SINCE, UNTIL, may("who", "Name at login.")])
        .with(&PAGE),
    ]
}

/// Paper and files.
fn printed() -> Vec<Offer> {
    let cycle = may("ideal_cycle_s", "Shortest cycle the line can keep, s.");
    vec![
        Offer::get(
            "/api/history/report/lot",
            HTML,
            "Report of a lot for A4.",
            paper::lot,
        )
        .with(&RUNS)
        .with(&[LANG, cycle]),
        Offer::get(
            "/api/history/report/certificate",
            HTML,
            "Certificate of a part for A4.",
            paper::certificate,
        )
        .with(&RUNS)
        .with(&[must("seq", "Number of the part."), LANG]),
        Offer::get(
            "/api/history/report/chart",
            HTML,
            "Control charts for A4.",
            paper::chart,
        )
        .with(&FILTER)
        .with(&[PARAM, LANG])
        .with(&CHART),
        Offer::get(
            "/api/history/report/alarms",
            HTML,
            "List of alarms for A4.",
            paper::alarms,
        )
        .with(&RUNS)
        .with(&[SINCE, UNTIL, LANG])
        .with(&PAGE),
        Offer::get(
            "/api/history/export.csv",
            "text/csv",
            "Parts as CSV with byte order mark.",
            export::csv,
        )
        .with(&FILTER)
        .with(&RANGE)
        .with(&PAGE),
        Offer::get(
            "/api/history/export.xlsx",
            "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
            "Parts as a spreadsheet with charts, 100,000 at most.",
            export::xlsx,
        )
        .with(&FILTER)
        .with(&RANGE)
        .with(&PAGE)
        .with(&[LANG]),
    ]
}
