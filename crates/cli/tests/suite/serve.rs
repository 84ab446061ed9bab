//! `bilux serve`: prints its address, serves the page, and ends when it is asked to.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

fn bilux(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_bilux"));
    command.args(arguments);
    command
}

fn generated(folder: &Path) -> String {
    let scene = folder.join("trio.toml").to_str().unwrap().to_owned();
    assert!(bilux(&["generate", "trio", "-o", &scene]).output().unwrap().status.success());
    scene
}

/// A viewer, and the address that it prints.
fn serve(arguments: &[&str]) -> (Child, String) {
    let mut child =
        bilux(&["serve"]).args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
    (child, line.trim().to_owned())
}

fn end(child: Child, signal: &str) -> Output {
    let killed = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    child.wait_with_output().unwrap()
}

fn get(host: &str, path: &str) -> String {
    let mut stream = TcpStream::connect(host).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    String::from_utf8_lossy(&answer).into_owned()
}

#[test]
#[cfg(unix)]
fn it_prints_its_address_serves_the_page_and_ends_on_ctrl_c() {
    let folder = tempfile::tempdir().unwrap();
    let scene = generated(folder.path());
    for signal in ["-INT", "-TERM"] {
        let (child, address) = serve(&[&scene, "--port", "0"]);
        let host =
            address.strip_prefix("http://").and_then(|rest| rest.strip_suffix('/')).unwrap().to_owned();
        assert!(host.starts_with("127.0.0.1:"), "{address}");
        assert!(get(&host, "/").contains("<title>Bilux</title>"));
        let port = host.split(':').nth(1).unwrap();
        let second = bilux(&["serve", &scene, "--port", port]).output().unwrap();
        let said = String::from_utf8_lossy(&second.stderr).into_owned();
        assert!(second.status.code() == Some(1) && said.contains("the port is in use"), "{said}");
        let output = end(child, signal);
        assert_eq!(output.status.code(), Some(0), "{signal}: {output:?}");
        assert!(output.stderr.is_empty(), "{output:?}");
    }
}

#[test]
#[cfg(unix)]
fn beyond_this_machine_the_address_has_a_secret() {
    let folder = tempfile::tempdir().unwrap();
    let scene = generated(folder.path());
    let (child, address) = serve(&[&scene, "--listen", "0.0.0.0"]);
    let parts: Vec<&str> = address.split('/').collect();
    assert!(parts.len() == 5 && parts[3].len() == 32, "{address}");
    let host = parts[2].replace("0.0.0.0", "127.0.0.1");
    assert!(get(&host, "/").starts_with("HTTP/1.1 403"));
    assert!(get(&host, &format!("/{}/", parts[3])).starts_with("HTTP/1.1 200"));
    end(child, "-TERM");
}

#[test]
#[cfg(unix)]
fn visitors_are_counted_and_may_share_a_view() {
    let folder = tempfile::tempdir().unwrap();
    let scene = generated(folder.path());
    for (wrong, word) in [("0", "1..=1000"), ("many", "invalid")] {
        let output = bilux(&["serve", &scene, "--visitors", wrong]).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(word), "{wrong}: {said}");
    }
    let (child, address) = serve(&[&scene, "--shared", "--visitors", "3"]);
    assert!(address.starts_with("http://127.0.0.1:"), "{address}");
    assert_eq!(end(child, "-TERM").status.code(), Some(0));
}

#[test]
fn what_cannot_be_watched_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scene = generated(folder.path());
    for (arguments, code, part) in [
        (vec!["missing.toml"], 1, "missing.toml"),
        (vec![&scene, "--port", "70000"], 2, "70000"),
        (vec![&scene, "--listen", "nowhere"], 2, "nowhere"),
        (vec![&scene, "--turntable", "4"], 2, "drag the picture"),
        (vec![&scene, "--set", "integrater=path"], 1, "integrator"),
        (vec![&scene, "--camera-eye", "1"], 2, "--camera-eye"),
        (vec!["-"], 1, "name a file"),
    ] {
        let output = bilux(&["serve"]).args(&arguments).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(part), "{arguments:?}: {said}");
    }
}

/// Surroundings that need no file are named in the help of each command that surrounds a scene.
#[test]
fn surroundings_of_the_table_are_in_the_help() {
    for command in ["render", "serve", "explain"] {
        let help = bilux(&[command, "--help"]).output().unwrap();
        let help = String::from_utf8_lossy(&help.stdout).into_owned();
        let values = help.split_once("--env <").and_then(|(_, rest)| rest.split_once('>')).unwrap().0;
        for row in bilux::presets::SURROUNDINGS {
            assert!(values.split('|').any(|value| value == row.name), "{command}: {values}");
        }
    }
}

#[test]
fn a_camera_is_moved_by_options() {
    let folder = tempfile::tempdir().unwrap();
    let scene = generated(folder.path());
    let render = |name: &str, more: &[&str]| {
        let file = folder.path().join(name);
        let plain = ["render", &scene, "-o", file.to_str().unwrap(), "--size", "24x16", "--spp", "1"];
        let output = bilux(&plain).args(more).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        std::fs::read(&file).unwrap()
    };
    let plain = render("plain.png", &[]);
    let moved = render("moved.png", &["--eye", "1,2,6", "--look-at", "0,0.5,0"]);
    let zoomed = render("zoomed.png", &["--zoom", "2"]);
    assert!(plain != moved && plain != zoomed && moved != zoomed);
    let wrong = bilux(&["render", &scene, "-o", "x.png", "--eye", "1,2"]).output().unwrap();
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("write X,Y,Z"), "{wrong:?}");
}

#[test]
fn a_change_on_the_command_line_is_that_of_an_overlay() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let box_of_cornell = file("cornell.toml");
    assert!(bilux(&["generate", "cornell", "-o", &box_of_cornell]).output().unwrap().status.success());
    let overlay = "base = \"cornell.toml\"\n[[change]]\nlight = \"lamp\"\nradiance = [3, 8.5, 20]\n\
                   [[change]]\ncamera = 0\nfov = 50\n";
    std::fs::write(file("edited.toml"), overlay).unwrap();
    let picture = |scene: &str, changes: &[&str]| {
        let out = file("out.png");
        let common = ["render", scene, "-o", &out, "--size", "24x20", "--spp", "2", "-i", "path", "--quiet"];
        let done = bilux(&common).args(changes).output().unwrap();
        assert!(done.status.success(), "{done:?}");
        std::fs::read(out).unwrap()
    };
    let changed = picture(
        &box_of_cornell,
        &["--change", "light:lamp:radiance=3,8.5,20", "--change", "camera:0:fov=50"],
    );
    assert!(changed == picture(&file("edited.toml"), &[]));
    assert!(changed != picture(&box_of_cornell, &[]));
}
