//! Requests for what no card and no shipped request shows: names and texts. Names of places are those of the shipped maps.

/// Every one.
pub(super) const FURTHER: [(&str, &str); 33] = [
    (
        "meets twice",
        r#"location = "office"
social_context = "An ordinary day"
task = "Deliver a parcel"
rough_scenario = "A nurse comes towards the robot in the corridor and they meet again at the other end"
"#,
    ),
    (
        "gives way",
        r#"location = "office"
social_context = "An ordinary day"
task = "Deliver a parcel"
rough_scenario = "A person comes towards the robot in the corridor and steps aside to let it pass"
"#,
    ),
    (
        "stops",
        r#"location = "warehouse"
social_context = "An ordinary day"
task = "Deliver a parcel"
rough_scenario = "A worker comes towards the robot in the aisle, stops for 4 seconds when the robot is near and walks on"
"#,
    ),
    (
        "comes from the left",
        r#"location = "office"
task = "Deliver mail"

[[human]]
relation = "crossing"
side = "left"

[[human]]
relation = "frontal"
"#,
    ),
    (
        "stands on the right, and signs to the robot",
        r#"location = "hospital"
task = "Deliver mail"

[[human]]
relation = "static"
place = "corridor"
side = "right"
facing = "away"
does = [{ when = { robot_near = 3.0 }, say = "WAIT", to = "robot", for_s = 3 }]

[[human]]
relation = "crossing"
"#,
    ),
    (
        "walks on the right, stops, and walks on slower",
        r#"location = "warehouse"
task = "Carry a box"

[[human]]
relation = "frontal"
side = "right"
does = [{ when = { robot_near = 5.0 }, act = "stand_still", for_s = 3 }, { act = { change_pace = "slow" } }]

[[human]]
relation = "crossing"
"#,
    ),
    (
        "turns back",
        r#"location = "warehouse"
task = "Bring a box"

[[human]]
relation = "frontal"
does = [{ when = { robot_near = 4.0 }, act = "turn_back" }]

[[human]]
relation = "crossing"
"#,
    ),
    (
        "goes to a ward",
        r#"location = "hospital"
task = "Bring medicine"

[[human]]
role = "nurse"
relation = "static"
place = "corridor"
does = [{ when = { robot_near = 4.0 }, act = { go_to = "ward 1" } }]

[[human]]
relation = "crossing"

[robot]
start = "pharmacy"
goal = "ward 2"
"#,
    ),
    (
        "a way by name",
        r#"location = "office"
task = "Bring the mail"

[[human]]
relation = "frontal"

[[human]]
relation = "crossing"

[robot]
start = "reception"
via = "corridor"
goal = "meeting room"
avoid = "kitchen"
"#,
    ),
    (
        "signs to another",
        r#"location = "hospital"
task = "Bring the mail"

[[human]]
id = "nurse"
role = "nurse"
relation = "static"
place = "corridor"
does = [
  { when = { robot_near = 4.0 }, say = "FOLLOW_ME", to = "visitor", for_s = 3 },
  { act = { look_at = "visitor" }, for_s = 4 },
]

[[human]]
id = "visitor"
relation = "static"
place = "corridor"
"#,
    ),
    (
        "side",
        r#"location = "office"
task = "Deliver a parcel"

[[human]]
relation = "crossing"
side = "left"
"#,
    ),
    (
        "facing",
        r#"location = "hospital"
task = "Deliver a parcel"

[[human]]
relation = "static"
place = "corridor"
facing = "robot"

[[human]]
relation = "frontal"
does = [{ when = { robot_near = 5.0 }, act = { change_pace = "slow" } }]
"#,
    ),
    (
        "sign to somebody",
        r#"location = "hospital"
task = "Deliver a parcel"

[[human]]
id = "guard"
relation = "static"
place = "corridor"
does = [{ when = { robot_near = 6.0 }, say = "WAIT", to = "visitor" }]

[[human]]
id = "visitor"
relation = "frontal"
place = "corridor"
"#,
    ),
    (
        "goes to a place",
        r#"location = "warehouse"
task = "Carry a box through the packing area"

[[human]]
role = "picker"
relation = "frontal"
does = [{ when = { robot_visible = 4.0 }, act = { go_to = "packing area" } }]
"#,
    ),
    (
        "ways by name",
        r#"location = "hospital"
task = "Deliver a parcel"

[robot]
start = "pharmacy"
goal = "ward 2"
avoid = "ward 1"

[[human]]
relation = "static"
place = "corridor"
"#,
    ),
    (
        "the robot asks, and waits",
        r#"location = "office"
task = "Deliver mail"

[[human]]
id = "colleague"
relation = "frontal"
place = "corridor"
pace = 1.0

[robot]
does = [{ when = { human_near = 4.0 }, say = "EXCUSE_ME" }, { when = { after_secs = 5.0 }, hold_s = 3 }]
"#,
    ),
    (
        "the robot waits until it may go",
        r#"location = "hospital"
task = "Deliver a parcel"

[[human]]
id = "guard"
relation = "static"
place = "corridor"
does = [
  { when = { robot_near = 4.0 }, say = "WAIT", for_s = 4 },
  { when = { done = "visitor" }, say = "PROCEED" },
]

[[human]]
id = "visitor"
relation = "crossing"

[robot]
does = [{ when = { human_says = "WAIT" }, hold_until = { human_says = "PROCEED" } }]
"#,
    ),
    (
        "they come up to the robot and go back",
        r#"location = "office"
task = "Deliver mail"

[[human]]
relation = "aside"
place = "corridor"
does = [{ when = { robot_visible = 8.0 }, act = "approach", for_s = 4 }, { act = "come_back" }]
"#,
    ),
    (
        "they turn their back",
        r#"location = "office"
task = "Deliver mail"

[[human]]
relation = "frontal"
place = "corridor"
does = [{ when = { robot_visible = 5.0 }, act = "turn_away", until = "robot_passed" }]
"#,
    ),
    (
        "the robot waits until they have crossed",
        r#"location = "office"
task = "Deliver mail"

[[human]]
id = "visitor"
relation = "crossing"

[robot]
does = [{ when = { near = ["visitor", 6.0] }, hold_until = { done = "visitor" } }]
"#,
    ),
    (
        "the robot waits where they meet",
        r#"location = "warehouse"
task = "Carry a box"

[[human]]
id = "picker"
relation = "crossing"

[robot]
does = [{ when = { at_encounter = "picker" }, hold_s = 5 }]
"#,
    ),
    (
        "the robot lets people out",
        r#"location = "hospital"
task = "Take the elevator to another floor"

[[human]]
count = 2
relation = "leaving"
place = "elevator"

[robot]
goal = "elevator"
does = [{ wait_for_leavers = true }]
"#,
    ),
    (
        "the robot follows",
        r#"location = "office"
task = "Go to the meeting room"

[[human]]
id = "guide"
relation = "ahead"
pace = "slow"

[robot]
does = [{ follow = "guide" }]
"#,
    ),
    (
        "the robot goes beside somebody",
        r#"location = "hospital"
task = "Deliver a parcel"

[[human]]
id = "nurse"
relation = "abreast"

[robot]
does = [{ beside = "nurse" }]
"#,
    ),
    (
        "the robot overtakes",
        r#"location = "hospital"
task = "Deliver a parcel"

[[human]]
id = "patient"
relation = "ahead"
pace = 0.4

[robot]
does = [{ overtake = "patient" }]
"#,
    ),
    (
        "the robot leads",
        r#"location = "office"
task = "Guide the visitor"

[[human]]
id = "visitor"
relation = "behind"
does = [{ when = { robot_says = "FOLLOW_ME" }, act = "follow_robot" }]

[robot]
does = [{ say = "FOLLOW_ME" }, { lead_m = 3.0 }]
"#,
    ),
    (
        "goes into a room",
        r#"location = "office"
task = "Leave the kitchen"

[[human]]
relation = "frontal"
place = "corridor"
goal = "room"
pace = 1.0

[robot]
start = "kitchen"
"#,
    ),
    (
        "looks, and turns back",
        r#"location = "hospital"
task = "Deliver a parcel"

[[human]]
relation = "frontal"
place = "corridor"
does = [{ when = { robot_near = 4.0 }, act = "look_at_robot", for_s = 2 }, { act = "turn_back" }]
"#,
    ),
    (
        "goes into the elevator",
        r#"location = "hospital"
task = "Take the elevator"

[[human]]
relation = "static"
place = "elevator_lobby"
goal = "elevator"

[robot]
goal = "elevator"
"#,
    ),
    (
        "a bystander has the robot wait",
        r#"location = "office"
task = "Deliver a parcel"

[[human]]
id = "guard"
relation = "aside"
place = "corridor"
does = [{ when = { robot_near = 5.0 }, say = "WAIT", to = "robot" }, { when = { done = "visitor" }, say = "PROCEED", to = "robot" }]

[[human]]
id = "visitor"
relation = "crossing"
"#,
    ),
    (
        "a group makes room",
        r#"location = "hospital"
task = "Deliver a parcel"

[[human]]
count = 3
relation = "static"
place = "corridor"
group = "chat"
does = [{ when = { robot_says = "EXCUSE_ME" }, act = "make_room" }]

[robot]
does = [{ when = { human_near = 3.0 }, say = "EXCUSE_ME" }]
"#,
    ),
    (
        "somebody makes room",
        r#"location = "warehouse"
task = "Deliver a parcel"

[[human]]
relation = "static"
place = "narrow_passage"
does = [{ when = { robot_near = 3.0 }, act = "make_room" }]
"#,
    ),
    (
        "there and back",
        r#"location = "office"
task = "Bring the mail to the reception"

[[human]]
relation = "frontal"
place = "corridor"
does = [{ when = { robot_visible = 5.0 }, act = { approach_to = 0.8 }, for_s = 4 }]

[robot]
return = true
"#,
    ),
];
