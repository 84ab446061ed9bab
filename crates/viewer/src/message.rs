//! Messages of a browser, in JSON: each is an object whose `do` names what is asked for.

use crate::dropped::Dropped;
use bilux::scene::{Part, Value};
use serde_json::Value as Json;
use tokio::sync::{mpsc, oneshot};

/// The maximum length of a message, in bytes.
pub(crate) const LONGEST: usize = 4096;

/// The sides that a picture may have, in pixels.
const SIDES: [u32; 2] = [16, 4096];

/// The maximum number of pixels.
const PIXELS: f64 = 3840.0 * 2160.0;

/// Channel for answers.
pub(crate) type Answers = mpsc::Sender<String>;

/// A message.
pub(crate) enum Message {
    /// The browser has shown a frame.
    Seen(u64),
    /// Something is asked for that concerns one's own view.
    Request(Request),
    /// Something is asked for that concerns the scene, which all share.
    Scene(SceneRequest),
}

/// Something that is asked for, or told, of a view.
pub(crate) enum Request {
    /// Move the camera.
    Move(Move),
    /// Render this width and height, in pixels.
    Size([u32; 2]),
    /// Change a setting.
    Set(String, Value),
    /// Show the picture or one of its layers.
    Show(String),
    /// Compare the picture with another one; `None` ends that.
    Compare(Option<Other>),
    /// While two pictures are compared, show where they differ in the place of the other one.
    Differences(bool),
    /// Answer a question.
    Ask(Question),
    /// There is another version of the scene.
    SceneChanged,
    /// The request to the scene is done, or cannot be done for this reason.
    Answered(Option<String>),
}

/// Something that is asked of the scene.
pub(crate) enum SceneRequest {
    /// Change a parameter of a material, a light or a camera.
    Edit {
        /// The kind of the part that is changed.
        part: Part,
        /// The number of the part.
        number: usize,
        /// The parameter.
        key: String,
        /// The new value.
        value: Value,
    },
    /// Undo the last edit.
    Undo,
    /// Make the last edit that was undone again.
    Redo,
    /// Open the scene with this variant of its materials; an empty name is the one at the start.
    Variant(String),
    /// Open the scene with this animation; an empty name stands for those at the start.
    Animation(String),
    /// Light the scene with this environment; an empty name is the one at the start.
    Environment(String),
    /// Show this time, in seconds.
    Time(Value),
    /// Open a file that was dropped in.
    Open(Dropped),
    /// Open the scene again.
    Reload,
}

impl SceneRequest {
    /// True if the next request makes this one needless, as long as neither has been done.
    pub(crate) fn gives_way_to(&self, next: &SceneRequest) -> bool {
        use SceneRequest::{Animation, Edit, Environment, Reload, Time, Variant};
        match (self, next) {
            (Edit { part, number, key, .. }, Edit { part: p, number: n, key: k, .. }) => {
                (part, number, key) == (p, n, k)
            }
            (Variant(_), Variant(_))
            | (Animation(_), Animation(_))
            | (Environment(_), Environment(_))
            | (Time(_), Time(_))
            | (Reload, Reload) => true,
            _ => false,
        }
    }
}

/// Picture to compare with.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Other {
    /// The picture with another setting.
    Setting(String, Value),
    /// The scene before it was edited.
    Unedited,
}

/// A question about the picture, and where its answer goes.
pub(crate) enum Question {
    /// The surface at a place of the picture, given as fractions of its width and height, and the light that gets there along this
    /// many paths.
    Pick {
        /// The place.
        at: [f32; 2],
        /// The number of paths.
        paths: u32,
        /// The channel for the answer.
        answers: Answers,
    },
    /// The picture as a file of this format.
    Save {
        /// The format's name.
        format: &'static str,
        /// The channel for the bytes, or for what went wrong.
        to: oneshot::Sender<Result<Vec<u8>, String>>,
    },
    /// The scene as it was edited, as an overlay of its file.
    Overlay {
        /// The channel for the overlay.
        to: oneshot::Sender<String>,
    },
    /// The speed of each accelerator.
    Measure {
        /// The channel for the answers, one for each accelerator.
        answers: Answers,
    },
}

/// A move of the camera.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Move {
    /// Around the pivot, by degrees to the right and up.
    Orbit([f64; 2]),
    /// Turn, by degrees to the right and up.
    Look([f64; 2]),
    /// To the right and up, in heights of the picture.
    Pan([f64; 2]),
    /// To the right, up and forward, in distances to the pivot.
    Fly([f64; 3]),
    /// Nearer by a factor.
    Approach(f64),
    /// Look at what is at a place of the picture, and move around it from now on.
    Focus([f64; 2]),
    /// To this position, looking at this point, with this magnification: where a page had it before.
    To([f64; 3], [f64; 3], f64),
    /// Back to where the scene has its camera.
    Home,
}

impl Move {
    /// Adds a move of the same kind to this one; false if it is of another kind.
    pub(crate) fn add(&mut self, next: &Move) -> bool {
        match (self, next) {
            (Move::Orbit(a), Move::Orbit(b))
            | (Move::Look(a), Move::Look(b))
            | (Move::Pan(a), Move::Pan(b)) => {
                (0..2).for_each(|i| a[i] += b[i]);
            }
            (Move::Fly(a), Move::Fly(b)) => (0..3).for_each(|i| a[i] += b[i]),
            (Move::Approach(a), Move::Approach(b)) => *a = (*a * b).clamp(1e-6, 1e6),
            (Move::Home, Move::Home) => {}
            (before @ Move::To(..), Move::To(..)) => *before = next.clone(),
            _ => return false,
        }
        true
    }
}

/// Reads a message from a browser, whose answers go to `answers`.
///
/// # Errors
/// What is wrong with it, for people.
pub(crate) fn parse(text: &str, answers: &Answers) -> Result<Message, String> {
    let json: Json = serde_json::from_str(text).map_err(|error| format!("a message is not JSON: {error}"))?;
    let what = json["do"].as_str().ok_or("a message has no 'do', which names what is asked for")?;
    let moved = |it: Move| Ok(Message::Request(Request::Move(it)));
    let asked = |it: Request| Ok(Message::Request(it));
    let of_scene = |it: SceneRequest| Ok(Message::Scene(it));
    match what {
        "seen" => Ok(Message::Seen(json["frame"].as_u64().ok_or("'seen' has no number of a frame")?)),
        "orbit" => moved(Move::Orbit(numbers(&json, "by", 3600.0)?)),
        "look" => moved(Move::Look(numbers(&json, "by", 3600.0)?)),
        "pan" => moved(Move::Pan(numbers(&json, "by", 100.0)?)),
        "fly" => moved(Move::Fly(numbers(&json, "by", 100.0)?)),
        "approach" => match json["by"].as_f64() {
            Some(factor) if (1e-3..=1e3).contains(&factor) => moved(Move::Approach(factor)),
            _ => Err("'approach' needs a factor 'by' from 0.001 to 1000".to_owned()),
        },
        "focus" => moved(Move::Focus(place(&json)?.map(f64::from))),
        "home" => moved(Move::Home),
        "view" => {
            let zoom = json["zoom"].as_f64().unwrap_or(1.0);
            if !(1e-2..=1e3).contains(&zoom) {
                return Err("'view' needs a 'zoom' from 0.01 to 1000".to_owned());
            }
            moved(Move::To(numbers(&json, "position", 1e9)?, numbers(&json, "pivot", 1e9)?, zoom))
        }
        "size" => asked(Request::Size(size(&json)?)),
        "set" => match (text_of(&json, "key")?, value(&json["value"])?) {
            (key, value) if key == "time" => of_scene(SceneRequest::Time(value)),
            (key, value) => asked(Request::Set(key, value)),
        },
        "show" => asked(Request::Show(text_of(&json, "what")?)),
        "edit" => of_scene(SceneRequest::Edit {
            part: json["part"].as_str().and_then(Part::named).ok_or("'edit' needs a part of the scene")?,
            number: json["number"].as_u64().ok_or("'edit' needs the number of a part")? as usize,
            key: text_of(&json, "key")?,
            value: value(&json["value"])?,
        }),
        "compare" => asked(Request::Compare(other(&json)?)),
        "differences" => {
            asked(Request::Differences(json["show"].as_bool().ok_or("'differences' needs 'show'")?))
        }
        "variant" => of_scene(SceneRequest::Variant(choice(&json)?)),
        "animation" => of_scene(SceneRequest::Animation(choice(&json)?)),
        "environment" => of_scene(SceneRequest::Environment(choice(&json)?)),
        "measure" => asked(Request::Ask(Question::Measure { answers: answers.clone() })),
        "undo" => of_scene(SceneRequest::Undo),
        "redo" => of_scene(SceneRequest::Redo),
        "pick" => {
            let paths = json["paths"].as_u64().unwrap_or(0).min(64) as u32;
            asked(Request::Ask(Question::Pick { at: place(&json)?, paths, answers: answers.clone() }))
        }
        _ => Err(format!("there is no '{}' to do", shortened(what))),
    }
}

/// Picture to compare with: by another value of a setting, of the scene without edits, or none.
fn other(json: &Json) -> Result<Option<Other>, String> {
    match json["with"].as_str() {
        Some("setting") => Ok(Some(Other::Setting(text_of(json, "key")?, value(&json["value"])?))),
        Some("unedited") => Ok(Some(Other::Unedited)),
        Some("nothing") => Ok(None),
        _ => Err("'compare' is with a 'setting', 'unedited' or with 'nothing'".to_owned()),
    }
}

/// Numbers within `-most..=most` under a key.
fn numbers<const N: usize>(json: &Json, key: &str, most: f64) -> Result<[f64; N], String> {
    let list = json[key].as_array().map(|list| list.iter().map(Json::as_f64).collect::<Option<Vec<f64>>>());
    let numbers = list.flatten().and_then(|list| <[f64; N]>::try_from(list).ok());
    let numbers = numbers.filter(|list| list.iter().all(|x| x.abs() <= most));
    numbers.ok_or_else(|| format!("'{key}' needs {N} numbers from -{most} to {most}"))
}

/// A place of the picture.
fn place(json: &Json) -> Result<[f32; 2], String> {
    let at: [f64; 2] = numbers(json, "at", 1.0)?;
    match at.iter().all(|x| (0.0..1.0).contains(x)) {
        true => Ok(at.map(|x| (x as f32).min(1.0f32.next_down()))),
        false => Err("'at' needs two fractions of the picture, from 0 to below 1".to_owned()),
    }
}

/// The size of a picture, limited to what makes sense.
fn size(json: &Json) -> Result<[u32; 2], String> {
    let sides: [f64; 2] = numbers(json, "to", 1e9)?;
    if sides.iter().any(|&side| side < 1.0) {
        return Err("'size' needs a width and a height of at least one pixel".to_owned());
    }
    // A window that is too large is shown a picture of its shape.
    let factor = (PIXELS / (sides[0] * sides[1])).sqrt().min(1.0);
    Ok(sides.map(|side| ((side * factor) as u32).clamp(SIDES[0], SIDES[1])))
}

fn text_of(json: &Json, key: &str) -> Result<String, String> {
    let text = json[key].as_str().filter(|text| !text.is_empty() && text.len() <= 256);
    text.map(str::to_owned).ok_or_else(|| format!("'{key}' needs a text of 1 to 256 bytes"))
}

/// Choice by its name; an empty name stands for what was chosen at the start.
fn choice(json: &Json) -> Result<String, String> {
    let name = json["name"].as_str().filter(|name| name.len() <= 256);
    name.map(str::to_owned).ok_or_else(|| "'name' needs a text of up to 256 bytes".to_owned())
}

/// A value of a setting or of a parameter.
fn value(json: &Json) -> Result<Value, String> {
    let number = |json: &Json| match (json.as_i64(), json.as_f64()) {
        (Some(i), _) => Some(Value::Integer(i)),
        (None, Some(x)) => Some(Value::Number(x)),
        _ => None,
    };
    let list = |list: &Vec<Json>| Some(Value::List(list.iter().map(number).collect::<Option<_>>()?));
    match json {
        Json::Bool(yes) => Some(Value::Bool(*yes)),
        Json::String(text) => Some(Value::Text(text.clone())),
        Json::Array(parts) if parts.len() <= 4 => list(parts),
        one => number(one),
    }
    .ok_or_else(|| "a value is true, false, a number, a text, or up to four numbers".to_owned())
}

/// The beginning of a text from outside.
fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parsed(text: &str) -> Result<Message, String> {
        parse(text, &mpsc::channel(1).0)
    }

    #[test]
    fn messages_are_read() {
        let orbit = parsed(r#"{"do":"orbit","by":[10,-2.5]}"#);
        assert!(matches!(orbit, Ok(Message::Request(Request::Move(Move::Orbit([10.0, -2.5]))))));
        assert!(matches!(parsed(r#"{"do":"seen","frame":7}"#), Ok(Message::Seen(7))));
        let size = parsed(r#"{"do":"size","to":[1e9, 3]}"#);
        assert!(matches!(size, Ok(Message::Request(Request::Size([4096, 16])))));
        let size = parsed(r#"{"do":"size","to":[7680, 4320]}"#);
        assert!(matches!(size, Ok(Message::Request(Request::Size([3840, 2160])))));
        let set = parsed(r#"{"do":"set","key":"spp","value":64}"#);
        assert!(matches!(set, Ok(Message::Request(Request::Set(_, Value::Integer(64))))));
    }

    #[test]
    fn only_moves_of_a_kind_add_up_in_all_their_parts() {
        let all = [
            (Move::Orbit([1.0, 2.0]), Move::Orbit([2.0, 4.0])),
            (Move::Look([3.0, 4.0]), Move::Look([6.0, 8.0])),
            (Move::Pan([5.0, 6.0]), Move::Pan([10.0, 12.0])),
            (Move::Fly([7.0, 8.0, 9.0]), Move::Fly([14.0, 16.0, 18.0])),
            (Move::Approach(3.0), Move::Approach(9.0)),
            (Move::Home, Move::Home),
            (Move::To([1.0; 3], [2.0; 3], 1.0), Move::To([1.0; 3], [2.0; 3], 1.0)),
        ];
        for (i, (first, sum)) in all.iter().enumerate() {
            for (j, (second, _)) in all.iter().enumerate() {
                let mut moved = first.clone();
                assert_eq!(moved.add(second), i == j, "{first:?} {second:?}");
                assert_eq!(moved, if i == j { sum.clone() } else { first.clone() });
            }
        }
        // Another point is another place to look at.
        assert!(!Move::Focus([0.1, 0.2]).add(&Move::Focus([0.1, 0.2])));
    }

    #[test]
    fn wrong_messages_say_what_is_wrong() {
        for (text, part) in [
            ("", "not JSON"),
            ("[]", "no 'do'"),
            (r#"{"do":3}"#, "no 'do'"),
            (r#"{"do":"dance"}"#, "dance"),
            (r#"{"do":"orbit","by":[1]}"#, "2 numbers"),
            (r#"{"do":"orbit","by":[1,1e300]}"#, "3600"),
            (r#"{"do":"approach","by":0}"#, "factor"),
            (r#"{"do":"view","position":[1,2,3],"pivot":[1,2]}"#, "3 numbers"),
            (r#"{"do":"view","position":[1,2,3],"pivot":[1,2,0],"zoom":0}"#, "'zoom'"),
            (r#"{"do":"size","to":[0,10]}"#, "at least one"),
            (r#"{"do":"pick","at":[1,0.5]}"#, "below 1"),
            (r#"{"do":"set","key":"","value":1}"#, "key"),
            (r#"{"do":"set","key":"a","value":{}}"#, "a value is"),
            (r#"{"do":"edit","part":"material","number":-1,"key":"a","value":1}"#, "number of a part"),
            (r#"{"do":"edit","part":"wall","number":0,"key":"a","value":1}"#, "a part of the scene"),
            (r#"{"do":"compare","key":"a","value":1}"#, "'compare' is with"),
            (r#"{"do":"differences"}"#, "'show'"),
            (r#"{"do":"variant"}"#, "'name'"),
            (r#"{"do":"animation","name":7}"#, "'name'"),
            (r#"{"do":"environment"}"#, "'name'"),
        ] {
            let error = parsed(text).err().unwrap_or_default();
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in ".{0,200}") {
            let _ = parsed(&text);
        }

        #[test]
        fn any_fields_are_read_or_refused(
            what in "(orbit|look|pan|fly|approach|focus|view|size|set|show|edit|pick|seen|home|compare|differences|variant|animation|environment)",
            key in "(by|at|to|position|pivot|zoom|key|what|value|number|frame|paths|with|show|name)",
            value in "(-?[0-9]{1,30}(\\.[0-9]{1,5})?(e-?[0-9]{1,3})?|\\[[0-9,.-]{0,20}\\]|\"[a-z]{0,9}\"|true|null|\\{\\})",
        ) {
            let _ = parsed(&format!(r#"{{"do":"{what}","{key}":{value}}}"#));
        }
    }
}
