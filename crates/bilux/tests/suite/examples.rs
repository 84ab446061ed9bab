//! The examples run, and their assertions hold.

#[path = "../../examples/edit_scene.rs"]
mod edit_scene;
#[path = "../../examples/pick.rs"]
mod pick;
#[path = "../../examples/render_to_buffer.rs"]
mod render_to_buffer;

#[test]
fn every_example_runs() {
    edit_scene::main().unwrap();
    pick::main().unwrap();
    render_to_buffer::main().unwrap();
}
