//! The table of fault codes: class, remedy and one line on each.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{FailureClass, Remedy};
use crate::ids::BadId;
use crate::job::Stage;

/// What a fault is about: the first letter of its code.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    /// `T-`: the way to the author's server.
    Transport,
    /// `E-`: the form of an answer.
    Answer,
    /// `P-`: the proposal, or the request it is made from.
    Proposal,
    /// `G-`: paths.
    Paths,
    /// `B-`: behavior trees.
    Behaviors,
    /// `D-`: what a run showed.
    Dynamic,
    /// `M-`: the location.
    Map,
    /// `J-`: a job.
    Job,
}

macro_rules! fault_codes {
    ($($code:literal $name:ident $class:ident $remedy:expr, $soft:literal, $about:literal;)*) => {
        /// Stable code of a fault; each has a page in `bus/model/faults/`.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
        #[non_exhaustive]
        pub enum FaultCode {
            $(#[doc = $about] #[serde(rename = $code)] $name,)*
        }

        impl FaultCode {
            /// Every code in order.
            pub const ALL: &'static [Self] = &[$(Self::$name,)*];

            /// Spelled as in logs and files.
            #[must_use]
            pub const fn code(self) -> &'static str {
                match self { $(Self::$name => $code,)* }
            }

            /// What it is about.
            #[must_use]
            pub const fn family(self) -> Family {
                match self.code().as_bytes() {
                    [b'T', ..] => Family::Transport,
                    [b'E', ..] => Family::Answer,
                    [b'P', ..] => Family::Proposal,
                    [b'G', ..] => Family::Paths,
                    [b'B', ..] => Family::Behaviors,
                    [b'D', ..] => Family::Dynamic,
                    [b'M', ..] => Family::Map,
                    _ => Family::Job,
                }
            }

            /// One line on what it means.
            #[must_use]
            pub const fn about(self) -> &'static str {
                match self { $(Self::$name => $about,)* }
            }

            /// Failure class.
            #[must_use]
            pub const fn class(self) -> FailureClass {
                match self { $(Self::$name => FailureClass::$class,)* }
            }

            /// What to do.
            #[must_use]
            pub const fn remedy(self) -> Remedy {
                match self { $(Self::$name => $remedy,)* }
            }

            /// A soft fault is a warning: it never fails an attempt.
            #[must_use]
            pub const fn is_soft(self) -> bool {
                match self { $(Self::$name => $soft,)* }
            }

            /// The page of this fault: what happened, what is done, what you can do.
            #[must_use]
            pub const fn page(self) -> &'static str {
                match self { $(Self::$name => include_str!(concat!("../../faults/", $code, ".md")),)* }
            }
        }
    };
}

fault_codes! {
    "T-NET" TNet Transient Remedy::Wait, false, "the author's server could not be reached";
    "T-429" T429 Overload Remedy::Wait, false, "the author's server asks to slow down";
    "T-5XX" T5xx Transient Remedy::Wait, false, "the author's server failed";
    "T-AUTH" TAuth Permanent Remedy::Stop, false, "the author's server refuses the key";
    "T-TIMEOUT" TTimeout Transient Remedy::Wait, false, "the author's server did not answer in time";
    "T-OVERSIZE" TOversize Unparsable Remedy::AskAgain, false, "the answer is larger than is read";
    "E-REFUSAL" ERefusal Permanent Remedy::AskPerson, false, "the model refuses to answer";
    "E-CANNOT" ECannot Semantic Remedy::AskAgain, false, "the author says that it cannot answer, and why";
    "E-TRUNC" ETrunc Unparsable Remedy::AskAgain, false, "the answer is cut off";
    "E-EMPTY" EEmpty Unparsable Remedy::AskAgain, false, "the answer is empty";
    "E-JSON" EJson Unparsable Remedy::AskAgain, false, "the answer is not JSON";
    "E-SCHEMA" ESchema Semantic Remedy::AskAgain, false, "the answer has not the asked form";
    "E-EXTRA" EExtra Unparsable Remedy::Repair, true, "there is text around the JSON object";
    "P-COUNT" PCount Semantic Remedy::AskAgain, false, "the number of humans is not what was asked";
    "P-NAME" PName Semantic Remedy::AskAgain, false, "humans are not named human_1 to human_n";
    "P-CAP" PCap Semantic Remedy::AskAgain, false, "a behavior cannot be simulated";
    "P-OTHER" POther Semantic Remedy::AskAgain, false, "a behavior depends on another human in a way that cannot be simulated";
    "P-PLACE" PPlace Semantic Remedy::AskAgain, false, "the map has no such place";
    "P-ACCOUNT" PAccount Semantic Remedy::AskAgain, false, "the reading of the request leaves something out, or says what is not there";
    "P-LABEL" PLabel Semantic Remedy::AskAgain, true, "the description names node ids";
    "P-ROUGH" PRough Semantic Remedy::AskAgain, false, "a wish of the request is missing in the proposal";
    "P-ROBOT" PRobot Semantic Remedy::AskAgain, false, "the robot's part is missing or not possible";
    "P-DUP" PDup Semantic Remedy::AskAgain, true, "the scenario repeats an earlier one";
    "P-VERIFY" PVerify Semantic Remedy::AskAgain, false, "a human or a wish has no clause that could be verified";
    "P-READ" PRead Permanent Remedy::AskPerson, true, "a wish of the request could not be read";
    "P-CONTRA" PContra Permanent Remedy::AskPerson, false, "two wishes of the request contradict each other";
    "P-LANG" PLang Permanent Remedy::AskPerson, false, "the request is not in English";
    "P-PERSON" PPerson Semantic Remedy::AskAgain, false, "a person sent it back";
    "P-LIMIT" PLimit Permanent Remedy::AskPerson, false, "the request asks for more than can be simulated";
    "G-AGENTS" GAgents Semantic Remedy::AskAgain, false, "paths are missing or given for nobody";
    "G-UNKNOWN" GUnknown Semantic Remedy::AskAgain, false, "a path names a node that the map does not have";
    "G-DISC" GDisc Semantic Remedy::AskAgain, false, "a path jumps where the scene graph has no edge";
    "G-EMPTY" GEmpty Semantic Remedy::AskAgain, false, "a path has no node";
    "G-SHORT" GShort Semantic Remedy::AskAgain, false, "a path is too short";
    "G-LOOP" GLoop Semantic Remedy::AskAgain, true, "a path goes back and forth without purpose";
    "G-MEET" GMeet Semantic Remedy::AskAgain, false, "an encounter is not on both paths";
    "G-MEETEND" GMeetEnd Semantic Remedy::AskAgain, false, "an encounter is at the end of a path";
    "G-TIME" GTime Semantic Remedy::AskAgain, true, "the two cannot be at the encounter at about the same time";
    "G-COLL" GColl Semantic Remedy::AskAgain, false, "two agents start on top of each other";
    "G-TYPE" GType Semantic Remedy::AskAgain, false, "the encounter is not at the place the proposal names";
    "G-REL" GRel Semantic Remedy::AskAgain, false, "the paths do not make the relation that was proposed";
    "G-GRP" GGrp Semantic Remedy::AskAgain, false, "a group's members are not together";
    "G-FREE" GFree Permanent Remedy::AskPerson, false, "a way of the map crosses walls and cannot be routed";
    "B-AGENTS" BAgents Semantic Remedy::AskAgain, false, "trees are missing or given for nobody";
    "B-XML" BXml Semantic Remedy::AskAgain, false, "a tree is not well-formed XML";
    "B-MAIN" BMain Semantic Remedy::AskAgain, false, "the main tree is missing or named twice";
    "B-NODE" BNode Semantic Remedy::AskAgain, false, "a tree uses a node that is not in the library";
    "B-PORT" BPort Semantic Remedy::AskAgain, false, "a node has missing, surplus or wrong ports";
    "B-RANGE" BRange Semantic Remedy::AskAgain, false, "a value of a tree is out of range";
    "B-ARITY" BArity Semantic Remedy::AskAgain, false, "a node has too many or too few children";
    "B-NAV" BNav Semantic Remedy::AskAgain, false, "a tree has no reachable regular navigation";
    "B-TIMER" BTimer Semantic Remedy::AskAgain, false, "a timer does not limit the action it should limit";
    "B-ORDER" BOrder Semantic Remedy::AskAgain, false, "a condition comes after the action it should guard";
    "B-DEAD" BDead Semantic Remedy::AskAgain, false, "a branch can never run";
    "B-MOVE2" BMove2 Semantic Remedy::AskAgain, false, "two motions run in one tick";
    "B-STILL" BStill Semantic Remedy::AskAgain, false, "the human can freeze without being told to";
    "B-LATCH" BLatch Semantic Remedy::AskAgain, false, "a gesture is never taken back";
    "B-HEAR" BHear Semantic Remedy::AskAgain, false, "a tree waits for a gesture that nobody makes";
    "B-CODE" BCode Semantic Remedy::AskAgain, false, "a gesture code is not in the table";
    "B-MATCH" BMatch Semantic Remedy::AskAgain, false, "a tree does not do what the proposal says";
    "B-CONTRA" BContra Semantic Remedy::AskAgain, false, "two rules want different motions at once";
    "D-NOTRIG" DNoTrig Semantic Remedy::BackTo(Stage::Behaviors), false, "a reaction was never triggered";
    "D-NOGEST" DNoGest Semantic Remedy::BackTo(Stage::Behaviors), false, "a gesture was never made";
    "D-NOMEET" DNoMeet Semantic Remedy::BackTo(Stage::Paths), false, "the robot and the human never met";
    "D-EARLY" DEarly Semantic Remedy::BackTo(Stage::Behaviors), false, "a reaction came long before the encounter";
    "D-STUCK" DStuck Semantic Remedy::BackTo(Stage::Paths), false, "somebody made no progress";
    "D-PEN" DPen Semantic Remedy::BackTo(Stage::Paths), false, "somebody went through a wall or a person";
    "D-GROUP" DGroup Semantic Remedy::BackTo(Stage::Paths), false, "a group did not stay together";
    "D-SETUP" DSetup Semantic Remedy::BackTo(Stage::Paths), false, "a setup clause was not seen";
    "M-READ" MRead Permanent Remedy::Stop, false, "a file of the location cannot be read";
    "M-IMAGE" MImage Permanent Remedy::Stop, false, "the map image is missing or broken";
    "M-KEY" MKey Permanent Remedy::Stop, false, "a file of the location has an unknown or missing key";
    "M-VALUE" MValue Permanent Remedy::Stop, false, "a value of the location is out of range";
    "M-ID" MId Permanent Remedy::Stop, false, "ids of the scene graph are not unique or not known";
    "M-PARTS" MParts Permanent Remedy::Stop, false, "the scene graph is not connected";
    "M-WALL" MWall Permanent Remedy::Stop, false, "a node or edge is not on free floor";
    "M-ROUTE" MRoute Semantic Remedy::Repair, true, "an edge crosses walls and was routed round them";
    "M-TYPE" MType Semantic Remedy::Repair, true, "a type of the scene graph says nothing";
    "J-PLANNER" JPlanner Permanent Remedy::Stop, false, "there is no such planner";
    "J-DRIVER" JDriver Permanent Remedy::Stop, false, "a driver outside did not drive the robot, or a person";
    "J-SPEC" JSpec Poison Remedy::Stop, false, "a job cannot be decoded";
    "J-PANIC" JPanic Poison Remedy::Stop, false, "a worker broke on this job";
    "J-BLOB" JBlob Transient Remedy::Wait, false, "an artifact could not be fetched or stored";
    "J-LOST" JLost WorkerDeath Remedy::Wait, false, "the worker was lost";
    "J-DEADLINE" JDeadline Transient Remedy::Wait, false, "the attempt took too long";
    "J-BUDGET" JBudget Permanent Remedy::Stop, false, "the budget of the scenario is spent";
    "J-REQUEST" JRequest Permanent Remedy::Stop, false, "the request is not valid";
    "J-VERSION" JVersion Permanent Remedy::Stop, false, "two parts of different versions cannot talk";
}

impl fmt::Display for FaultCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.code())
    }
}

impl FromStr for FaultCode {
    type Err = BadId;
    fn from_str(text: &str) -> Result<Self, BadId> {
        let spelled = text.trim().to_ascii_uppercase();
        Self::ALL.iter().copied().find(|code| code.code() == spelled).ok_or_else(|| BadId {
            what: "fault code",
            found: text.chars().take(40).collect(),
            allowed: "a code such as G-DISC; `socrates explain` lists them",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_read_back_and_has_a_page() {
        for code in FaultCode::ALL {
            assert_eq!(code.code().parse::<FaultCode>().unwrap(), *code);
            assert!(code.page().starts_with(&format!("# {code}")), "{code}");
            assert!(code.page().len() > 120, "{code} has a thin page");
        }
    }

    #[test]
    fn the_family_of_a_code_is_its_first_letter() {
        let letters = |family: Family| match family {
            Family::Transport => "T-",
            Family::Answer => "E-",
            Family::Proposal => "P-",
            Family::Paths => "G-",
            Family::Behaviors => "B-",
            Family::Dynamic => "D-",
            Family::Map => "M-",
            Family::Job => "J-",
        };
        for code in FaultCode::ALL {
            assert!(code.code().starts_with(letters(code.family())), "{code}");
        }
    }
}
