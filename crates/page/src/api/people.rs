//! The routes of people.

use super::Route;
use crate::access::Role;
use crate::{login, people};

pub(super) fn routes() -> Vec<Route> {
    vec![
        Route::get(
            "/api/setup/needed",
            "Whether the first engineer is still to be added.",
            login::needs_setup,
        )
        .refuses(&[500]),
        Route::post(
            "/api/setup",
            "Adds the first engineer and opens a session as a login does; 401 when there is an engineer.",
            login::set_up,
        )
        .refuses(&[401, 404, 409, 429, 500, 503]),
        Route::post(
            "/api/password",
            "Changes one's own password and opens a new session; the other sessions of the person end.",
            login::set_own_password,
        )
        .refuses(&[404, 409, 429, 503])
        .needs(Role::Operator),
        Route::get(
            "/api/people",
            "Everybody with role, since when, and until when wrong passwords forbid a login.",
            people::list,
        )
        .needs(Role::Engineer),
        Route::post(
            "/api/people/change",
            "A change of a person; 404 for an unknown one, 409 for a taken name and for the last engineer. The answer has the \
             password if the rig drew one.",
            people::change,
        )
        .refuses(&[404, 409, 503])
        .needs(Role::Engineer),
    ]
}
