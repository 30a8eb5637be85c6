//! The routes of the page: what it asks, and what it is answered.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

use axum::Router;
use axum::body::Bytes;
use axum::extract::rejection::{BytesRejection, PathRejection};
use axum::extract::{DefaultBodyLimit, Path, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse as _, Response};
use axum::routing::{get, post};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};
use socrates_edit::{Edit, Spot, TILE_PX, elevator, inside_of, levels, line, opening, seen, tile, way};
use socrates_gateway::guard::Rules;
use socrates_maps::Ground;
use socrates_model::{Location, NodeId, PlaceClass};

use super::board::{Board, Checker, Refusal};
use super::page;
use super::walk::walk;
use crate::loopback::{self, body, refused, told};

/// Bytes of a request, at most: a sketch of the largest size.
const MOST_BYTES: usize = 16 << 20;
/// Types that are offered first, in the order of the keys 1 to 9; one for each class of places.
const KINDS: [&str; 11] = [
    "CORRIDOR",
    "INTERSECTION",
    "DOORWAY",
    "ROOM",
    "OPEN AREA",
    "BLIND CORNER",
    "NARROW PASSAGE",
    "EXIT",
    "ELEVATOR LOBBY",
    "IN ELEVATOR",
    "CORRIDOR END",
];
/// What a stranger is told, and what an answer without a page may do: nothing.
const WORDS: loopback::Words = loopback::Words {
    stranger: "only the page of this editor and programs of this machine may ask here",
    token: "the token is missing or wrong; open the address that `socrates map edit` printed",
    policy: "default-src 'none'; frame-ancestors 'none'",
};

/// What all answers share.
pub(super) struct Shared {
    pub(super) board: Mutex<Board>,
    pub(super) checker: Checker,
    /// The map, with nothing drawn on it.
    pub(super) map: Location,
}

type Answer = Result<Response, Response>;

/// The routes of an editor.
pub(super) fn routes(shared: Arc<Shared>, rules: Arc<Rules>) -> Router {
    let door = Arc::new(loopback::Door { rules, words: WORDS });
    let of_page = Router::new()
        .route("/map", get(map))
        .route("/state", get(state))
        .route("/findings", get(findings))
        .route("/tile/{level}/{column}/{row}", get(one_tile))
        .route("/edit", post(edit))
        .route("/undo", post(undo))
        .route("/redo", post(redo))
        .route("/save", post(save))
        .route("/theirs", post(theirs))
        .route("/line", post(look_along))
        .route("/opening", post(find_opening))
        .route("/elevator", post(add_elevator))
        .route("/way", post(walk_way))
        .route("/propose", post(propose))
        .route("/accept", post(accept))
        .layer(DefaultBodyLimit::max(MOST_BYTES));
    let all = Router::new().route("/", get(page::page)).merge(door.with_token(of_page)).fallback(nowhere);
    door.guarded(all).with_state(shared)
}

async fn nowhere() -> Response {
    refused(StatusCode::NOT_FOUND, "there is nothing at this address; the page is at /", None, "unknown_url")
}

/// Works where it may take long.
async fn at_work(shared: Arc<Shared>, work: impl FnOnce(&Shared) -> Answer + Send + 'static) -> Answer {
    let done = tokio::task::spawn_blocking(move || work(&shared)).await;
    done.unwrap_or_else(|why| {
        let message = format!("the editor broke at this ({why}); what is drawn is in the journal");
        Err(refused(StatusCode::INTERNAL_SERVER_ERROR, &message, None, "broken"))
    })
}

/// What the page sent, as a type.
fn read<T: DeserializeOwned>(bytes: Result<Bytes, BytesRejection>) -> Result<T, Response> {
    let bytes = body(bytes, MOST_BYTES)?;
    serde_json::from_slice(&bytes).map_err(|why| {
        let message = format!("the page sent what cannot be read ({why}); load it anew");
        refused(StatusCode::BAD_REQUEST, &message, None, "invalid_value")
    })
}

/// Why something was not done, for the page.
fn not_done(why: &Refusal, board: &Board) -> Response {
    match why {
        Refusal::Stale => {
            let error =
                json!({"message": "another page changed the sketch; it is shown as it is now", "code": "stale"});
            (StatusCode::CONFLICT, told(&json!({"error": error, "state": board.state("")}))).into_response()
        }
        Refusal::Changed(files) => {
            let message = format!("{} was changed by another program since it was read", files.join(" and "));
            let error = json!({"message": message, "code": "changed", "files": files});
            (StatusCode::CONFLICT, told(&json!({"error": error}))).into_response()
        }
        Refusal::ReadOnly => {
            let message = "this editor only looks (`--read-only`): nothing is changed";
            refused(StatusCode::FORBIDDEN, message, None, "read_only")
        }
        Refusal::Edit(why) => refused(StatusCode::UNPROCESSABLE_ENTITY, &why.to_string(), None, "edit"),
        Refusal::Nothing(why) => refused(StatusCode::UNPROCESSABLE_ENTITY, why, None, "nothing"),
        Refusal::Outside(why) => {
            let message = format!("{}: {}", why.short(), why.hint);
            refused(StatusCode::UNPROCESSABLE_ENTITY, &message, None, "outside")
        }
    }
}

impl Shared {
    /// Does something to the sketch and answers how it stands then.
    fn act(&self, act: impl FnOnce(&mut Board) -> Result<Value, Refusal>) -> Answer {
        let mut board = self.board.lock().unwrap_or_else(PoisonError::into_inner);
        match act(&mut board) {
            Ok(state) => Ok(told(&state)),
            Err(why) => Err(not_done(&why, &board)),
        }
    }

    /// The sketch as it is, and its number.
    fn now(&self) -> (u64, socrates_edit::Sketch) {
        let board = self.board.lock().unwrap_or_else(PoisonError::into_inner);
        (board.revision(), board.sketch().clone())
    }
}

async fn map(State(shared): State<Arc<Shared>>) -> Answer {
    let grid = &shared.map.grid;
    let board = shared.board.lock().unwrap_or_else(PoisonError::into_inner);
    let classes: Map<String, Value> =
        KINDS.iter().map(|kind| ((*kind).to_owned(), json!(PlaceClass::of_type(kind).name()))).collect();
    Ok(told(&json!({
        "name": shared.map.name, "folder": board.folder(), "notes": board.notes,
        "width": grid.width, "height": grid.height, "resolution_m": grid.resolution_m,
        "origin": [grid.origin.x, grid.origin.y, grid.origin.yaw],
        "seen": seen(grid), "tile_px": TILE_PX, "levels": levels(grid), "kinds": KINDS, "classes": classes,
    })))
}

async fn state(State(shared): State<Arc<Shared>>) -> Answer {
    shared.act(|board| Ok(board.state("")))
}

async fn findings(State(shared): State<Arc<Shared>>) -> Answer {
    at_work(shared, |shared| {
        let (rev, sketch) = shared.now();
        Ok(told(&shared.checker.with(rev, &sketch, |_, remarks| json!({"rev": rev, "findings": remarks}))))
    })
    .await
}

async fn one_tile(State(shared): State<Arc<Shared>>, path: Result<Path<(u32, usize, usize)>, PathRejection>) -> Answer {
    let none = || refused(StatusCode::NOT_FOUND, "there is no such tile", None, "unknown_tile");
    let Path((level, column, row)) = path.map_err(|_why| none())?;
    at_work(shared, move |shared| {
        let bytes = tile(&shared.map.grid, level, column, row).ok_or_else(none)?;
        Ok(([(header::CONTENT_TYPE, "image/png"), (header::CACHE_CONTROL, "no-store")], bytes).into_response())
    })
    .await
}

/// An edit of the sketch of a number.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WithEdit {
    rev: u64,
    edit: Edit,
}

async fn edit(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Answer {
    let WithEdit { rev, edit } = read(bytes)?;
    at_work(shared, move |shared| shared.act(|board| board.act(rev, edit))).await
}

/// The number of the sketch that something is asked of.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rev {
    rev: u64,
}

async fn undo(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Answer {
    let Rev { rev } = read(bytes)?;
    at_work(shared, move |shared| shared.act(|board| board.undo(rev))).await
}

async fn redo(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Answer {
    let Rev { rev } = read(bytes)?;
    at_work(shared, move |shared| shared.act(|board| board.redo(rev))).await
}

/// A wish to save.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Save {
    rev: u64,
    /// Whether files that another program changed are written over.
    #[serde(default)]
    overwrite: bool,
}

async fn save(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Answer {
    let Save { rev, overwrite } = read(bytes)?;
    at_work(shared, move |shared| shared.act(|board| board.save(rev, overwrite, &shared.map))).await
}

async fn theirs(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Answer {
    let Rev { rev } = read(bytes)?;
    at_work(shared, move |shared| shared.act(|board| board.take_theirs(rev))).await
}

/// Two places of the image.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Two {
    from: Spot,
    to: Spot,
}

async fn look_along(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Answer {
    let Two { from, to } = read(bytes)?;
    at_work(shared, move |shared| Ok(told(&json!(line(&shared.map, from, to))))).await
}

/// Where a door is wanted: near a place, or on a line.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum Wanted {
    Near(Spot),
    On(Spot, Spot),
}

async fn find_opening(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Answer {
    let wanted: Wanted = read(bytes)?;
    at_work(shared, move |shared| {
        let (_, sketch) = shared.now();
        let (from, to) = match wanted {
            Wanted::Near(at) => opening(&shared.map, at).map(|found| (found.from, found.to)).ok_or_else(no_opening)?,
            Wanted::On(from, to) => (from, to),
        };
        let inside = inside_of(&sketch, &shared.map, from, to);
        Ok(told(&json!({"from": from, "to": to, "inside": inside, "id": sketch.free_door("door")})))
    })
    .await
}

fn no_opening() -> Response {
    let message = "no two walls face each other here within 4 m; draw the line of the door from wall to wall";
    refused(StatusCode::UNPROCESSABLE_ENTITY, message, None, "no_opening")
}

/// A place of the image, on the sketch of a number.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct At {
    rev: u64,
    at: Spot,
}

async fn add_elevator(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Answer {
    let At { rev, at } = read(bytes)?;
    at_work(shared, move |shared| {
        let found = opening(&shared.map, at).ok_or_else(no_opening)?;
        let (_, sketch) = shared.now();
        let edit = elevator(&sketch, &shared.map, &found).ok_or_else(|| {
            let message = "the floor behind this opening is less than 1 m deep; a car needs room for two nodes";
            refused(StatusCode::UNPROCESSABLE_ENTITY, message, None, "no_car")
        })?;
        shared.act(|board| board.act(rev, edit))
    })
    .await
}

/// Two nodes.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Ends {
    from: NodeId,
    to: NodeId,
}

async fn walk_way(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Answer {
    let Ends { from, to } = read(bytes)?;
    at_work(shared, move |shared| {
        let (rev, sketch) = shared.now();
        let found = shared.checker.with(rev, &sketch, |location, _| way(location, &from, &to));
        let found = found.map_err(|why| refused(StatusCode::UNPROCESSABLE_ENTITY, &why.to_string(), None, "no_way"))?;
        let walked = walk(&Ground::of(&shared.map.grid), &found.points);
        let points: Vec<Spot> = found.points.iter().map(|point| Spot::of(&shared.map.grid, point)).collect();
        Ok(told(&json!({"rev": rev, "way": found, "points": points, "walk": walked})))
    })
    .await
}

async fn propose(State(shared): State<Arc<Shared>>) -> Answer {
    at_work(shared, |shared| {
        let found = proposal(shared)?;
        let remarks: Vec<Value> = found.remarks.iter().map(|(at, text)| json!({"at": at, "text": text})).collect();
        Ok(told(&json!({"sketch": found.sketch, "remarks": remarks})))
    })
    .await
}

fn proposal(shared: &Shared) -> Result<Arc<socrates_edit::Proposal>, Response> {
    shared.checker.proposal(&shared.map).map_err(|faults| {
        let told: Vec<String> = faults.iter().map(ToString::to_string).collect();
        refused(StatusCode::UNPROCESSABLE_ENTITY, &told.join("; "), None, "no_proposal")
    })
}

/// What of the proposal is taken over.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Accept {
    rev: u64,
    /// Nodes of the proposal; none for all of it.
    nodes: Option<BTreeSet<NodeId>>,
}

async fn accept(State(shared): State<Arc<Shared>>, bytes: Result<Bytes, BytesRejection>) -> Answer {
    let Accept { rev, nodes } = read(bytes)?;
    at_work(shared, move |shared| {
        let found = proposal(shared)?;
        shared.act(|board| {
            let edit = found.taken_over(board.sketch(), &shared.map.grid, nodes.as_ref());
            board.act(rev, edit.ok_or(Refusal::Nothing("all of it is drawn already"))?)
        })
    })
    .await
}
