//! Somebody who meets the robot twice, as a fact.

use socrates_model::{FactKind, Fault, FaultCode, HumanId, Location, PlaceClass, Reading, Relation};

use crate::place;

/// The fact of somebody who is to meet the robot twice, where that can be played.
pub(crate) fn fact(
    human: HumanId,
    relation: Option<Relation>,
    (place, quote): &(Option<PlaceClass>, String),
    location: &Location,
    reading: &mut Reading,
) -> Option<(String, FactKind)> {
    let mut problem = |code: FaultCode, message: String| {
        let fault = Fault::new(code, human, message).about([quote.as_str()]);
        if !reading.problems.contains(&fault) {
            reading.problems.push(fault);
        }
    };
    let walks = relation.is_none_or(|relation| {
        matches!(
            relation,
            Relation::Frontal | Relation::Crossing | Relation::Leaving | Relation::Ahead | Relation::Abreast
        )
    });
    if !walks {
        problem(
            FaultCode::PRead,
            format!(
                "`{quote}`: who stands or goes behind the robot meets it once; ask for somebody who comes towards it or crosses its way"
            ),
        );
        return None;
    }
    let graph = &location.graph;
    let through = |class: PlaceClass| {
        graph.nodes().iter().any(|node| graph.node_is(&node.id, class) && graph.neighbors(&node.id).len() > 1)
    };
    if let Some(class) = place.filter(|class| !through(*class)) {
        problem(
            FaultCode::PPlace,
            format!(
                "`{quote}` asks for a second meeting at {}, where on this map no way leads on; it is elsewhere on the robot's way",
                place::an(class)
            ),
        );
    }
    let place = place.filter(|class| through(*class));
    Some((quote.clone(), FactKind::MeetsTimes { human, times: 2, place }))
}
