//! The routes of plans for tooling.

use super::{OF_HISTORY, Route};
use crate::access::Role;
use crate::plans;

pub(super) fn routes() -> Vec<Route> {
    vec![
        Route::get(
            "/api/plans/scenes",
            "Scenes of the configuration with the ids of their elements.",
            plans::scenes,
        )
        .refuses(&[500]),
        Route::get(
            "/api/plans/list",
            "Plans that people started, the latest first.",
            plans::list,
        )
        .refuses(OF_HISTORY),
        Route::get(
            "/api/plans/show",
            "A plan with its pictures, and with the persons who did its steps.",
            plans::show,
        )
        .refuses(OF_HISTORY),
        Route::get("/api/plans/paper", "The same for A4.", plans::print).refuses(OF_HISTORY),
        Route::post(
            "/api/plans/preview",
            "A plan with its pictures; stores nothing. 409 with the elements that lock each other when no order exists.",
            plans::preview,
        )
        .refuses(&[409, 500, 503]),
        Route::post(
            "/api/plans/start",
            "Makes a plan and stores it as under way; 409 while another one is.",
            plans::start,
        )
        .refuses(&[404, 409, 503])
        .needs(Role::Maintainer),
        Route::post(
            "/api/plans/tick",
            "Ticks off the next step of the plan under way; 409 for any other step.",
            plans::tick,
        )
        .refuses(&[404, 409, 503])
        .needs(Role::Maintainer),
        Route::post(
            "/api/plans/untick",
            "Takes back the tick of the last step done of the plan under way; 409 for any other step.",
            plans::untick,
        )
        .refuses(&[404, 409, 503])
        .needs(Role::Maintainer),
        Route::post(
            "/api/plans/abandon",
            "Ends a plan before all its steps are done, with a reason.",
            plans::abandon,
        )
        .refuses(&[404, 409, 503])
        .needs(Role::Maintainer),
    ]
}
