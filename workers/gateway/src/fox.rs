//! Foxglove and Lichtblick: their WebSocket protocol and the messages of a run in it. Pure: bytes in, bytes out.
//!
//! ```text
//! Facts ─► Stage ─ frame, event ─► Message (topic, time, shared bytes) ─► Session::give ─► Out, for each viewer
//!            └── what a late viewer has to be given ──► Session::hear ◄── what a viewer sent
//! ```
//!
//! One [`Stage`] per run that is shown, one [`Session`] per viewer. What nobody subscribed to is not encoded; what is encoded is
//! encoded once and shared, and of each viewer's own are the 13 bytes before it. Never here: a socket, a clock, a task, and
//! anything of a viewer that reaches a run.

pub mod channels;
pub mod client;
pub mod encode;
pub mod facts;
pub mod protocol;
mod scene;
pub mod session;
pub mod stage;

pub use bytes::Bytes;
pub use channels::{Topic, Topics};
pub use client::{BadMessage, Inbound};
pub use facts::{Door, Facts, Frame, Message};
pub use protocol::{Level, SUBPROTOCOLS, pick};
pub use session::{Ask, Heard, Out, Playback, Session};
pub use stage::Stage;

/// A layout for both programs: the scene from above following the robot, the events, the speed of the robot.
pub const LAYOUT: &str = include_str!("../layout/foxglove.json");

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    fn panels(layout: &Value) -> Vec<&str> {
        if let Some(panel) = layout.as_str() {
            return vec![panel];
        }
        [&layout["first"], &layout["second"]].into_iter().flat_map(panels).collect()
    }

    #[test]
    fn the_layout_shows_topics_that_there_are_in_panels_that_it_configures() {
        let layout: Value = serde_json::from_str(LAYOUT).unwrap();
        let configured: Vec<&str> = layout["configById"].as_object().unwrap().keys().map(String::as_str).collect();
        let mut placed = panels(&layout["layout"]);
        placed.sort_unstable();
        assert_eq!(placed, configured);
        let names: Vec<&str> = channels::CATALOG.iter().map(|sheet| sheet.name).collect();
        let drawn = layout["configById"]["3D!scene"]["topics"].as_object().unwrap();
        for (topic, settings) in drawn {
            assert!(names.contains(&topic.as_str()) && settings["visible"] == true, "{topic}");
        }
        for topic in ["/map", "/scene", "/tf", "/scan", "/robot/plan", "/crowd", "/socrates/labels"] {
            assert!(drawn.contains_key(topic), "{topic}");
        }
        assert_eq!(layout["configById"]["RosOut!events"]["topicToRender"], Topic::Events.sheet().name);
        let schema = Topic::Odometry.schema();
        for path in layout["configById"]["Plot!speed"]["paths"].as_array().unwrap() {
            let path = path["value"].as_str().unwrap().strip_prefix(Topic::Odometry.sheet().name).unwrap();
            let field = path.split('.').nth(1).unwrap();
            assert!(schema.windows(field.len()).any(|bytes| bytes == field.as_bytes()), "{field}");
        }
    }

    #[test]
    fn the_colors_of_the_layout_are_of_fields_that_are_sent() {
        use foxglove::Decode as _;
        let layout: Value = serde_json::from_str(LAYOUT).unwrap();
        let topics = &layout["configById"]["3D!scene"]["topics"];
        let crowd = encode::crowd([].into_iter(), socrates_model::SimTime::ZERO);
        let fields = foxglove::messages::PointCloud::decode(crowd).unwrap().fields;
        assert!(fields.iter().any(|field| topics["/crowd"]["colorField"] == field.name.as_str()));
        assert_eq!(topics["/map"]["colorField"], "occupancy");
    }
}
