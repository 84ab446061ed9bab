//! Meanings of the specular keywords of MTL by program, told by the first line of a library. `Ks` and `Ns` stay what they are
//! in those of all others: 3ds Max, Maya, Cinema 4D, Rhino, SketchUp and Wings 3D write Phong's.

use bilux_import::bytes::text::Cursor;

/// The habit of a program: `Ks` is the specular level, of which 0.5 is a reflection of 4%, and `Ns` says how rough the surface is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Habit {
    /// Beginning of the first line.
    first_line: &'static str,
    /// `Ns` of a roughness r is so much times (1 - r)².
    pub(super) smooth: f32,
}

/// The habits of programs; the first that fits counts.
static HABITS: &[Habit] = &[
    // Up to 3.0, without a version: (30 (1 - r))². [Blender 2.93, io_scene_obj/export_obj.py]
    Habit { first_line: "# Blender MTL File", smooth: 900.0 },
    // Since 3.1: 1000 (1 - r)². [Blender 4.1, io/wavefront_obj/exporter/obj_export_mtl.cc]
    Habit { first_line: "# Blender ", smooth: 1000.0 },
];

/// Habit of the program that wrote a library; `None` for all others.
pub(super) fn habit_of(library: &[u8]) -> Option<Habit> {
    let mut cursor = Cursor::new(library);
    let line = loop {
        let line = cursor.rest_of_line().trim_ascii();
        if !line.is_empty() || cursor.is_done() {
            break line;
        }
        cursor.end_line();
    };
    HABITS.iter().find(|habit| line.starts_with(habit.first_line.as_bytes())).copied()
}
