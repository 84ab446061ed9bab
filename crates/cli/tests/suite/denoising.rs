//! When pictures are denoised, by what, and what is reported about it; default budgets; layers; what is behind a model.

use assert_cmd::Command;
use bilux::pictures::formats::read;
use std::path::Path;
use tempfile::TempDir;

/// Returns what Bilux prints when no Open Image Denoise is available, so that every machine does the same.
fn bilux(folder: &Path, arguments: &[&str]) -> String {
    let mut command = Command::cargo_bin("bilux").expect("the binary is built with its tests");
    command.current_dir(folder).env("OIDN_LIB", "nowhere").args(arguments);
    let assert = command.assert().success().stdout("");
    String::from_utf8(assert.get_output().stderr.clone()).unwrap()
}

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    bilux(folder.path(), &["generate", "teapot", "--set", "tessellation=3", "-o", "pot.obj"]);
    folder
}

fn render(folder: &Path, output: &str, more: &[&str]) -> String {
    let always = ["render", "pot.obj", "-i", "path", "--size", "32x32", "-o", output];
    bilux(folder, &[&always, more].concat())
}

#[test]
fn display_pictures_ended_by_noise_or_time_are_denoised() {
    let folder = folder();
    let path = folder.path();
    let said = render(path, "a.png", &["--noise", "0.3"]);
    assert!(
        said.contains("denoised by the built-in filter") && !said.contains("OIDN_LIB names a library"),
        "{said}"
    );
    // Advice is for people: it is on a terminal, or with -v.
    assert!(render(path, "a.png", &["--noise", "0.3", "-v"]).contains("OIDN_LIB names a library"));
    for off in ["--denoise=off", "--denoise=none", "--set=denoise=none"] {
        assert!(!render(path, "b.png", &["--noise", "0.3", off]).contains("denoised"), "{off}");
    }
    assert!(!render(path, "b.exr", &["--noise", "0.3"]).contains("denoised"));
    assert!(!render(path, "c.png", &["--spp", "2"]).contains("denoised"));
    let said = render(path, "d.png", &["--spp", "2", "--denoise"]);
    assert!(said.contains("denoised by the built-in filter"), "{said}");
    let bytes = |name: &str| std::fs::read(path.join(name)).unwrap();
    assert_ne!(bytes("c.png"), bytes("d.png"));
    // With an explicit denoiser and a fixed number of samples, the result is the same for any number of threads.
    render(path, "e.png", &["--spp", "2", "--denoise=builtin", "--threads", "3"]);
    assert_eq!(bytes("d.png"), bytes("e.png"));
}

#[test]
fn default_settings_have_a_budget() {
    let folder = folder();
    let said = render(folder.path(), "a.png", &["-v"]);
    assert!(said.contains("renders until 2% noise or 5 s") && said.contains("denoised by"), "{said}");
    let said =
        bilux(folder.path(), &["render", "pot.obj", "-v", "-i", "whitted", "--size", "8x8", "-o", "b.png"]);
    assert!(!said.contains("until") && !said.contains("denoised"), "{said}");
    // A part belongs to a picture with a fixed number of samples.
    let said = render(folder.path(), "c.exr", &["-v", "--crop", "0,0,8,8"]);
    assert!(!said.contains("until"), "{said}");
}

#[test]
fn layers_in_the_exr_guide_denoising() {
    let folder = folder();
    let path = folder.path();
    let aovs = ["--spp", "4", "--aov", "albedo,normal,depth,ids,guides,variance"];
    render(path, "plain.exr", &["--spp", "4"]);
    render(path, "noisy.exr", &aovs);
    let (plain, noisy) = (read(path.join("plain.exr")).unwrap(), read(path.join("noisy.exr")).unwrap());
    // They change no sample.
    assert_eq!(plain.to_rgb(), noisy.to_rgb());
    let mut layers = noisy.layers();
    layers.sort_unstable();
    assert_eq!(layers, ["albedo", "depth", "guides", "id", "normal", "variance"]);
    render(path, "shown.png", &aovs);
    assert_eq!(read(path.join("shown.layers.exr")).unwrap().to_rgb(), noisy.to_rgb());
    let said = bilux(path, &["denoise", "noisy.exr", "-o", "smooth.exr"]);
    assert!(said.contains("denoised by the built-in filter"), "{said}");
    let smooth = read(path.join("smooth.exr")).unwrap();
    assert_ne!(smooth.to_rgb(), noisy.to_rgb());
    assert_eq!(smooth.channel("depth.Z"), noisy.channel("depth.Z"));
    // The result is the same as when denoising is part of the render; the noisy picture is kept in a layer.
    render(path, "at-once.exr", &["--spp", "4", "--denoise"]);
    let at_once = read(path.join("at-once.exr")).unwrap();
    assert_eq!(at_once.to_rgb(), smooth.to_rgb());
    assert_eq!(at_once.layer("noisy").unwrap().to_rgb(), noisy.to_rgb());
}

#[test]
fn a_denoiser_that_is_not_there_is_an_error_that_says_how_to_get_it() {
    let folder = folder();
    let mut command = Command::cargo_bin("bilux").unwrap();
    let arguments = ["render", "pot.obj", "--spp", "1", "--denoise=oidn", "-o", "a.png"];
    command.current_dir(folder.path()).env("OIDN_LIB", "nowhere").args(arguments);
    let output = command.assert().code(2).stdout("").get_output().stderr.clone();
    let said = String::from_utf8(output).unwrap();
    assert!(said.contains("OIDN_LIB names a library that cannot be used: nowhere"), "{said}");
    assert!(!folder.path().join("a.png").exists());
}

/// Messages about denoising of a default picture if `python3` is a script that prints `printed`, and nothing else is
/// installed.
#[cfg(unix)]
fn said_with_python(folder: &Path, printed: &str) -> String {
    use std::os::unix::fs::PermissionsExt;
    let bin = folder.join("bin");
    std::fs::create_dir_all(&bin).unwrap();
    let python = bin.join("python3");
    std::fs::write(&python, format!("#!/bin/sh\necho '{printed}'\n")).unwrap();
    std::fs::set_permissions(&python, std::fs::Permissions::from_mode(0o755)).unwrap();
    let mut command = Command::cargo_bin("bilux").unwrap();
    let arguments = ["render", "pot.obj", "--size", "16x16", "--noise", "0.5", "-v", "-o", "a.png"];
    command.current_dir(folder).env_clear().env("PATH", &bin).env("HOME", folder).args(arguments);
    String::from_utf8(command.assert().success().get_output().stderr.clone()).unwrap()
}

/// pyenv's `python3` is a script: only it knows where packages are.
#[cfg(unix)]
#[test]
fn python3_locates_pyoidn_and_installed_packages_are_not_advertised() {
    let folder = folder();
    let package = folder.path().join("versions/3.12/pyoidn");
    let said = said_with_python(folder.path(), "");
    if said.contains("denoised by Open Image Denoise") {
        return; // The system has one.
    }
    assert!(said.contains("pip install pyoidn"), "{said}");
    // A file that is not a library: it is found and reported as unusable.
    std::fs::create_dir_all(package.join("oidn/lib")).unwrap();
    std::fs::write(package.join("oidn/lib/libOpenImageDenoise.so.2"), "no library").unwrap();
    let said = said_with_python(folder.path(), &package.display().to_string());
    let is_true = said.contains("is installed, but cannot be used") && !said.contains("pip install");
    assert!(is_true || cfg!(target_os = "macos"), "{said}");
}

/// The scripts of pyenv say by where they lie which version they start: a thumbnail need not wait for one.
#[cfg(unix)]
#[test]
fn pyoidn_of_pyenv_is_found_and_its_python3_is_not_started() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let root = folder.path().join("pyenv");
    let package = root.join("versions/3.12.4/lib/python3.12/site-packages/pyoidn/oidn/lib");
    std::fs::create_dir_all(&package).unwrap();
    std::fs::write(package.join("libOpenImageDenoise.so.2"), "no library").unwrap();
    std::fs::create_dir_all(root.join("versions/3.11.0")).unwrap();
    std::fs::write(root.join("version"), "3.11.0\n").unwrap();
    std::fs::create_dir_all(root.join("shims")).unwrap();
    let shim = root.join("shims/python3");
    std::fs::write(&shim, format!("#!/bin/sh\n: >{}\n", folder.path().join("started").display())).unwrap();
    std::fs::set_permissions(&shim, std::fs::Permissions::from_mode(0o755)).unwrap();
    let said = |version: &str| {
        let mut command = Command::cargo_bin("bilux").unwrap();
        let arguments = ["render", "pot.obj", "--size", "16x16", "--noise", "0.5", "-v", "-o", "a.png"];
        command
            .current_dir(folder.path())
            .env_clear()
            .env("PATH", root.join("shims"))
            .env("HOME", folder.path());
        command.env("PYENV_VERSION", version).args(arguments);
        String::from_utf8(command.assert().success().get_output().stderr.clone()).unwrap()
    };
    let without = said("");
    assert!(!folder.path().join("started").exists());
    if without.contains("denoised by Open Image Denoise") {
        return; // The system has one.
    }
    assert!(without.contains("pip install pyoidn"), "the usual version has none: {without}");
    // The version that this folder has.
    std::fs::write(folder.path().join(".python-version"), "3.12.4\n").unwrap();
    for said in [said(""), said("3.12.4:3.11.0")] {
        let is_found = said.contains("is installed, but cannot be used");
        assert!(is_found || cfg!(target_os = "macos"), "{said}");
    }
    assert!(said("3.11.0").contains("pip install pyoidn"));
    assert!(!folder.path().join("started").exists());
    // A version that is not there is asked for.
    said("3.9.1");
    assert!(folder.path().join("started").exists());
}

/// In a sandbox the library is loaded before the scene is read, so that its error is reported as it is without a
/// sandbox.
#[cfg(target_os = "linux")]
#[test]
fn a_sandbox_loads_the_library_before_the_scene_is_read() {
    let folder = folder();
    let mut command = Command::cargo_bin("bilux").unwrap();
    let arguments = ["--sandbox", "render", "missing.obj", "--denoise=oidn", "-o", "a.png"];
    // The dynamic linker prints what it looks for, in order.
    command.current_dir(folder.path()).env("LD_DEBUG", "files").env("OIDN_LIB", "nowhere").args(arguments);
    let said = String::from_utf8_lossy(&command.assert().failure().get_output().stderr.clone()).into_owned();
    let place = |what: &str| said.find(what).unwrap_or_else(|| panic!("no {what} in {said}"));
    assert!(place("file=nowhere") < place("missing.obj"));
}

#[test]
fn a_timeout_ends_with_the_picture_as_it_is() {
    let folder = folder();
    let mut said = String::new();
    // Before the first sample there is nothing to save: a loaded machine needs longer for it.
    for seconds in ["2", "8", "30"] {
        let mut command = Command::cargo_bin("bilux").unwrap();
        let arguments = ["render", "pot.obj", "--spp", "1000000", "--size", "64x64", "-o", "a.png"];
        command.current_dir(folder.path()).args(arguments).args(["--timeout", seconds]);
        said = String::from_utf8(command.assert().code(124).get_output().stderr.clone()).unwrap();
        if folder.path().join("a.png").exists() {
            break;
        }
    }
    assert!(said.contains("--timeout") && folder.path().join("a.png").exists(), "{said}");
    // The message says the time as it was given.
    let mut command = Command::cargo_bin("bilux").unwrap();
    let arguments = ["render", "pot.obj", "--size", "3000x3000", "--timeout", "0.01", "-o", "c.png"];
    command.current_dir(folder.path()).args(arguments);
    let said = String::from_utf8(command.assert().code(124).get_output().stderr.clone()).unwrap();
    assert!(said.contains("the time of 0.01 s was up"), "{said}");
    // Without a picture there is nothing to save; and a time of 0 is not a timeout.
    for wrong in ["0", "-1", "soon"] {
        let mut command = Command::cargo_bin("bilux").unwrap();
        command.current_dir(folder.path()).args(["render", "pot.obj", "-o", "b.png"]);
        command.arg(format!("--timeout={wrong}")).assert().code(2);
    }
}

#[test]
fn fast_pictures_are_path_traced_and_denoised() {
    let folder = folder();
    let said = render(folder.path(), "a.png", &["--fast"]);
    assert!(said.contains("denoised by") && !said.contains("chose"), "{said}");
    let mut command = Command::cargo_bin("bilux").unwrap();
    command.current_dir(folder.path()).args(["render", "pot.obj", "-o", "b.png", "--fast", "--spp", "4"]);
    command.assert().code(2);
}

#[test]
fn the_background_is_what_was_asked_for() {
    let folder = folder();
    let path = folder.path();
    let seen = |background: &str, more: &[&str]| {
        render(path, "a.png", &[&["--spp", "4", "--background", background], more].concat());
        read(path.join("a.png")).unwrap()
    };
    let corner = |background: &str, more: &[&str]| {
        seen(background, more).rgb(0, 0).to_array().map(|c| (c * 255.0).round())
    };
    assert_eq!(corner("white", &[]), [255.0; 3]);
    // It is not a light, so no tone curve and no exposure changes it.
    assert_eq!(corner("#336699", &["--tonemap", "agx", "--exposure", "3"]), [51.0, 102.0, 153.0]);
    assert_eq!(corner("0,1,0", &["--denoise"]), [0.0, 255.0, 0.0]);
    let cut = seen("transparent", &[]);
    assert_eq!((cut.alpha_at(0, 0), cut.alpha_at(16, 16)), (0.0, 1.0));
    let half = (0..32 * 32).filter(|i| (0.1..0.9).contains(&cut.alpha_at(i % 32, i / 32))).count();
    assert!(half > 20, "edges are smooth: {half} pixels");
    render(path, "a.exr", &["--spp", "4", "--background", "transparent"]);
    assert_eq!(read(path.join("a.exr")).unwrap().alpha_at(0, 0), 0.0);
    // A picture of the surroundings is shown as it is, and the studio's lights stay.
    let mut sky = bilux::pictures::Picture::new(4, 2).unwrap();
    sky.push_rgb("", &[bilux::math::Rgb::new(0.0, 0.0, 1.0); 8]).unwrap();
    bilux::pictures::write(path.join("sky.hdr"), &sky, &bilux::pictures::WriteOptions::default()).unwrap();
    assert_eq!(corner("sky.hdr", &["--tonemap", "none"]), [0.0, 0.0, 255.0]);
    let middle = |background: &str| seen(background, &["--tonemap", "none"]).rgb(16, 16);
    let apart = (middle("sky.hdr") - middle("black")).map(f32::abs).max_channel();
    assert!(apart < 0.01, "{apart}");
    for wrong in ["whte", "#12345"] {
        let mut command = Command::cargo_bin("bilux").unwrap();
        command.current_dir(path).args(["render", "pot.obj", "-o", "b.png", "--background", wrong]);
        let said = String::from_utf8(command.assert().code(2).get_output().stderr.clone()).unwrap();
        assert!(said.contains(wrong) && said.contains("#rrggbb"), "{said}");
    }
    let mut command = Command::cargo_bin("bilux").unwrap();
    command.current_dir(path).args(["render", "pot.obj", "-o", "b.png", "--denoise", "builtin"]);
    let said = String::from_utf8(command.assert().code(2).get_output().stderr.clone()).unwrap();
    assert!(said.contains("--denoise=builtin"), "{said}");
    // A missing scene that happens to be called so is only a missing scene.
    let mut command = Command::cargo_bin("bilux").unwrap();
    command.current_dir(path).args(["render", "builtin", "-o", "b.png"]);
    let said = String::from_utf8(command.assert().code(1).get_output().stderr.clone()).unwrap();
    assert!(said.contains("builtin: cannot open it"), "{said}");
}

/// A room that takes seconds for a sample: the picture is complete, says how few it has, and a part of it is none of another picture.
#[test]
fn time_that_is_too_short_for_a_sample_gives_a_whole_picture() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    bilux(path, &["generate", "indirect", "-o", "room.toml"]);
    let short = |output: &str, more: &[&str]| {
        let always = ["render", "room.toml", "--size", "400x300", "--time-limit", "0.02", "-o", output];
        bilux(path, &[&always, more].concat())
    };
    let said = short("a.png", &["-v"]);
    let words =
        ["samples per pixel", "denoised by the built-in filter", "pixels without one are interpolated"];
    assert!(words.iter().all(|words| said.contains(words)), "{said}");
    let samples: f64 =
        said.split("400x300, ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap().parse().unwrap();
    assert!((0.01..0.9).contains(&samples), "{said}");
    // Where the time went adds up to all of it.
    let line = said.split("seconds for ").nth(1).and_then(|rest| rest.lines().next()).unwrap();
    let parts: Vec<f64> = line.split([' ', ',']).filter_map(|word| word.parse().ok()).collect();
    let seconds = said.split("per pixel, ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    let seconds: f64 = seconds.parse().unwrap();
    assert_eq!(parts.len(), 7, "{line}");
    assert!((parts.iter().sum::<f64>() - seconds).abs() < 0.1 + 0.1 * seconds, "{said}");
    // Unlike the picture of as many seconds as it takes, it cannot be made again.
    short("b.exr", &["--aov", "samples"]);
    let picture = read(path.join("b.exr")).unwrap();
    assert!(!picture.metadata.contains_key("bilux.settings"), "{:?}", picture.metadata.keys());
    let light = picture.to_rgb().unwrap();
    assert_eq!(light.len(), 400 * 300);
    // A sample may find no light; pixels without one are not black for that.
    let lit = light.iter().filter(|light| light.is_finite() && light.luminance() > 0.0).count();
    assert!(lit > 9 * light.len() / 10, "{lit}");
    let counts = picture.channel("samples.count").unwrap();
    let on_lattice = |i: usize| (i % 400).is_multiple_of(8) && (i / 400).is_multiple_of(8);
    assert!((0..counts.len()).filter(|i| on_lattice(*i)).all(|i| counts[i] == 1.0));
    assert!(counts.contains(&0.0));
    // The mean is that of the room.
    bilux(path, &["render", "room.toml", "--size", "100x75", "--spp", "8", "-o", "c.exr"]);
    let mean = |light: &[bilux::math::Rgb]| {
        light.iter().map(|light| f64::from(light.luminance())).sum::<f64>() / light.len() as f64
    };
    let whole = mean(&read(path.join("c.exr")).unwrap().to_rgb().unwrap());
    assert!((mean(&light) / whole - 1.0).abs() < 0.3, "{}, not {whole}", mean(&light));
}
