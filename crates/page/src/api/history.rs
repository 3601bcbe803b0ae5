//! The routes of the history; `../history.rs` explains their members.

use super::{HTML, JSON, Member, Route, may, must};
use crate::history::{self, export, paper, rejudge};

const LOT: Member = may("lot", "Name of the lot.");
const RUN: Member = may("run", "Number of the run within its lot.");
const RECIPE: Member = may("recipe", "Name of the recipe.");
const SINCE: Member = may("since", "Earliest time, RFC 3339.");
const UNTIL: Member = may("until", "Time before which the entries lie, RFC 3339.");
const VERDICT: Member = may("verdict", "`pass`, `fail`, `void`, `unjudged`.");
const BIN: Member = may("bin", "Bin of the verdict.");
const KIND: Member = may("kind", "`lot` (without it), `golden`, `all`.");
const SUSPECT: Member = may(
    "suspect",
    "`true`: only parts between a passed reference check and a failed one.",
);
const PARAM: Member = may("param", "Parameter key with its unit, as in an export.");
const MIN: Member = may("min", "Least value of `param`.");
const MAX: Member = may("max", "Largest value of `param`.");
const LIMIT: Member = may("limit", "Most entries of the answer.");
const OFFSET: Member = may("offset", "Number of entries to skip.");
const LANG: Member = may("lang", "`zh` (without it) or `en`.");
const SUBGROUP: Member = may("subgroup", "Parts of a subgroup, 1 to 10; 1 without it.");
const RULES: Member = may("rules", "`nelson` (without it) or `western-electric`.");
const LAST: Member = may(
    "last",
    "Number of points, counted from the last; 200 without it.",
);

const RUNS: [Member; 3] = [LOT, RUN, RECIPE];
const PAGE: [Member; 2] = [LIMIT, OFFSET];
const FILTER: [Member; 9] = [LOT, RUN, RECIPE, SINCE, UNTIL, VERDICT, BIN, KIND, SUSPECT];
const RANGE: [Member; 3] = [PARAM, MIN, MAX];
const CHART: [Member; 3] = [SUBGROUP, RULES, LAST];

pub(super) fn routes() -> Vec<Route> {
    let mut routes = read();
    routes.extend(printed());
    routes
}

fn read() -> Vec<Route> {
    let about_one = [must("param", PARAM.about)];
    vec![
        Route::get(
            "/api/history/list",
            JSON,
            "Runs of lots with their counts.",
            history::list,
        )
        .with(&RUNS),
        Route::get(
            "/api/history/show",
            JSON,
            "The part `seq` of every run, down to the raw replies.",
            history::show,
        )
        .with(&[
            must("lot", LOT.about),
            must("seq", "Number of the part."),
            RUN,
            KIND,
        ]),
        Route::get(
            "/api/history/query",
            JSON,
            "Parts that match the filter.",
            history::query,
        )
        .with(&FILTER)
        .with(&RANGE)
        .with(&PAGE),
        Route::get(
            "/api/history/count",
            JSON,
            "Number of parts that `query` would return.",
            history::count,
        )
        .with(&FILTER)
        .with(&RANGE),
        Route::get(
            "/api/history/yield",
            JSON,
            "Counts of the verdicts of all parts of lots in the span.",
            history::yields,
        )
        .with(&[SINCE, UNTIL]),
        Route::get(
            "/api/history/stats",
            JSON,
            "Statistics of one parameter.",
            history::stats,
        )
        .with(&FILTER)
        .with(&about_one),
        Route::get(
            "/api/history/histogram",
            JSON,
            "Counts in classes of equal width.",
            history::histogram,
        )
        .with(&FILTER)
        .with(&about_one),
        Route::get("/api/history/spc", JSON, "Control charts.", history::spc)
            .with(&FILTER)
            .with(&[PARAM])
            .with(&CHART),
        Route::get(
            "/api/history/alarms",
            JSON,
            "Alarms in order of time.",
            history::alarms,
        )
        .with(&RUNS)
        .with(&[SINCE, UNTIL])
        .with(&PAGE),
        Route::get(
            "/api/history/rejudge",
            JSON,
            "The verdict of every part of the lot by another recipe, then a summary; writes nothing.",
            rejudge::rejudge,
        )
        .with(&[
            must("lot", LOT.about),
            must("recipe", "Name of a recipe of the plant."),
            RUN,
            may("changed", "`true`: only parts whose verdict changes."),
        ]),
        Route::get(
            "/api/history/orders",
            JSON,
            "The audit of orders: person, order and outcome.",
            history::orders,
        )
        .with(&RUNS)
        .with(&[SINCE, UNTIL, may("who", "Name at login.")])
        .with(&PAGE),
    ]
}

/// Returns the routes of printed reports and of exports.
fn printed() -> Vec<Route> {
    let cycle = may("ideal_cycle_s", "Shortest cycle the line can keep, s.");
    vec![
        Route::get(
            "/api/history/report/lot",
            HTML,
            "Report of a lot for A4.",
            paper::lot,
        )
        .with(&RUNS)
        .with(&[LANG, cycle]),
        Route::get(
            "/api/history/report/certificate",
            HTML,
            "Certificate of a part for A4.",
            paper::certificate,
        )
        .with(&RUNS)
        .with(&[must("seq", "Number of the part."), LANG]),
        Route::get(
            "/api/history/report/chart",
            HTML,
            "Control charts for A4.",
            paper::chart,
        )
        .with(&FILTER)
        .with(&[PARAM, LANG])
        .with(&CHART),
        Route::get(
            "/api/history/report/alarms",
            HTML,
            "List of alarms for A4.",
            paper::alarms,
        )
        .with(&RUNS)
        .with(&[SINCE, UNTIL, LANG])
        .with(&PAGE),
        Route::get(
            "/api/history/export.csv",
            "text/csv",
            "Parts as CSV with byte order mark.",
            export::csv,
        )
        .with(&FILTER)
        .with(&RANGE)
        .with(&PAGE),
        Route::get(
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
