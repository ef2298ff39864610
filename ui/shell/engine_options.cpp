// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What drivers say of themselves and of the options of their addresses, in other languages.
#include "ui/shell/engine_words.h"

namespace dubsar::ui {

namespace {

constexpr EnginePhrase kOptions[] = {
    // drivers, and what stands after the colon
    {"a made-up tablet before a simulated scanner", "eine erfundene Tafel vor einem simulierten Scanner"},
    {"a made-up tablet on a turntable before a simulated triangulation scanner",
     "eine erfundene Tafel auf einem Drehteller vor einem simulierten Triangulationsscanner"},
    {"cameras that Linux drives (UVC and the like)", "Kameras, die Linux betreibt (UVC und ähnliche)"},
    {"GigE Vision and USB3 Vision cameras and range cameras",
     "Kameras und Tiefenkameras mit GigE Vision oder USB3 Vision"},
    {"motion and laser: GRBL, Horus and TMCL controllers over USB",
     "Bewegung und Laser: Steuerungen mit GRBL, Horus oder TMCL an USB"},
    {"recorded range grids, played as if they were scanned now",
     "aufgezeichnete Scans, abgespielt, als würden sie jetzt gescannt"},
    {"camera, stage and calibration together, as a file describes them",
     "Kamera, Tisch und Kalibrierung zusammen, wie eine Datei sie beschreibt"},
    {"a folder or a file of range grids (PLY, PTX, points, Dubsar grids)",
     "ein Ordner oder eine Datei mit Scans (PLY, PTX, Punkte, Gitter von Dubsar)"},
    // cameras
    {"what the camera sends, by its four letters, e.g. GREY; default: the best for stripes",
     "was die Kamera sendet, mit seinen vier Buchstaben, etwa GREY; sonst das beste für Streifen"},
    {"width x height, e.g. 1280x1024; default: the largest of that format",
     "Breite x Höhe, etwa 1280x1024; sonst die größte dieses Formats"},
    {"frames per second, at least; default: the fastest",
     "Bilder in der Sekunde, mindestens; sonst die schnellsten"},
    {"frames in the pool; default: half a second of them", "Bilder im Puffer; sonst eine halbe Sekunde"},
    {"frames in the pool; default: half a second of them, 256 MiB at most",
     "Bilder im Puffer; sonst eine halbe Sekunde, höchstens 256 MiB"},
    {"pixel format by its GenICam name, e.g. Mono8 or Coord3D_AC16; default: the best",
     "Pixelformat mit seinem Namen in GenICam, etwa Mono8 oder Coord3D_AC16; sonst das beste"},
    {"size of GigE packets; default: what the network carries",
     "Größe der GigE-Pakete; sonst was das Netz trägt"},
    {"ask for lost packets again; default: 1", "verlorene Pakete noch einmal anfordern; sonst 1"},
    {"take packets before the kernel's own network stack, where that is allowed; default: 1",
     "Pakete schon vor dem Netzwerkteil des Kernels nehmen, wo das erlaubt ist; sonst 1"},
    {"of range cameras: profiles in a scan; default: 1000", "bei Tiefenkameras: Profile je Scan; sonst 1000"},
    {"of range cameras: motion from row to row; default: the camera's scale of B",
     "bei Tiefenkameras: Weg von Zeile zu Zeile; sonst der Maßstab der Kamera für B"},
    {"of range cameras: motion for a count of the encoder; default: rows are evenly spaced",
     "bei Tiefenkameras: Weg je Schritt des Gebers; sonst liegen die Zeilen gleich weit auseinander"},
    {"of range cameras: C grows away from the scanner; default: 0",
     "bei Tiefenkameras: C wächst vom Scanner weg; sonst 0"},
    {"of range cameras: for the next profiles; default: 1.5",
     "bei Tiefenkameras: so lange auf die nächsten Profile warten; sonst 1.5"},
    // stages
    {"what the controller speaks; auto tells grbl and horus by their banner",
     "was die Steuerung spricht; auto erkennt grbl und horus an ihrem Gruß"},
    {"its axes in their order, those that turn with :deg, e.g. x,y:deg; default: x",
     "ihre Achsen der Reihe nach, drehende mit :deg, etwa x,y:deg; sonst x"},
    {"soft limits of each axis, e.g. 0..120,-90..90; own or default: the controller's, tmcl has none",
     "Grenzen jeder Achse, etwa 0..120,-90..90; bei own oder ohne die der Steuerung, tmcl hat keine"},
    {"of tmcl: microsteps per mm, or per degree; one for all axes or one for each, e.g. 1600,88.9",
     "bei tmcl: Mikroschritte je mm oder Grad; eine Zahl, oder eine je Achse, etwa 1600,88.9"},
    {"of tmcl: the greatest speed; one for all axes or one for each",
     "bei tmcl: die größte Geschwindigkeit; eine Zahl, oder eine je Achse"},
    {"of tmcl: the module's address", "bei tmcl: die Adresse des Moduls"},
    {"of tmcl: the digital output that the laser hangs on",
     "bei tmcl: der digitale Ausgang, an dem der Laser hängt"},
    {"of tmcl: whether its axes have reference switches to home to; default: yes",
     "bei tmcl: ob ihre Achsen Referenzschalter haben; sonst yes"},
    // recorded scans
    {"what the numbers in the files are; without it the file's own word, else mm",
     "was die Zahlen in den Dateien sind; sonst was die Datei selbst sagt, oder mm"},
    // the simulated scanner
    {"of tablet, noise, pins and hands; default: 1", "für Tafel, Rauschen, Nadeln und Hände; sonst 1"},
    {"of the tablet, WxHxT, each 5 to 300; default: 50x40x20",
     "der Tafel, Breite x Höhe x Dicke, je 5 bis 300; sonst 50x40x20"},
    {"lateral spacing of the samples; default: 0.1", "seitlicher Abstand der Messpunkte; sonst 0.1"},
    {"of the depth, one standard deviation; default: 0.02", "der Tiefe, eine Standardabweichung; sonst 0.02"},
    {"edge length of the true surface; default: that of the samples",
     "Kantenlänge der wahren Fläche; sonst die der Messpunkte"},
    {"a mesh file to be scanned instead of a made-up tablet",
     "eine Netzdatei, die statt einer erfundenen Tafel gescannt wird"},
    {"1: fifteen fiducial pins stand around the tablet; default: 0",
     "1: fünfzehn Nadeln stehen um die Tafel; sonst 0"},
    {"share of the room for text that is written on; default: 1",
     "wie viel der Schreibfläche beschrieben ist; sonst 1"},
    {"fractures, erosion, dirt and cracks, from none to badly; default: 0.3",
     "Brüche, Abrieb, Schmutz und Risse, von keinen bis schlimm; sonst 0.3"},
    {"what is driven; default: turntable", "was Motoren hat; sonst turntable (Drehteller)"},
    {"that a move takes; default: 0", "die eine Fahrt dauert; sonst 0"},
    {"this move, from 0, ends half way with a fault",
     "diese Fahrt, ab 0, endet auf halbem Weg mit einem Fehler"},
    {"this scan, from 0, ends in the middle with a fault",
     "dieser Scan, ab 0, endet mittendrin mit einem Fehler"},
    {"rows of the scan that stops; default: 30", "Zeilen des Scans, der abbricht; sonst 30"},
    {"hand@N (over half of the tablet), glove@N (over all of it), grip@N (fingers at its edge) or gone@N "
     "(the "
     "tablet is away): in scan N, from 0, in N-M, or in each Kth of these, N-M/K",
     "hand@N (über der halben Tafel), glove@N (über der ganzen), grip@N (Finger am Rand) oder gone@N (die "
     "Tafel ist weg): im Scan N, ab 0, in N-M, oder in jedem K-ten davon, N-M/K"},
    {"another tablet lies there from this scan on", "ab diesem Scan liegt eine andere Tafel da"},
    {"firing holes, from none to many; default: 0", "Brennlöcher, von keinen bis vielen; sonst 0"},
    {"a folder that gets the truth: poses, pins and the surface",
     "ein Ordner für die Wahrheit: Lagen, Nadeln und die Fläche"},
};

}  // namespace

std::span<const EnginePhrase> engine_options() {
  return kOptions;
}

}  // namespace dubsar::ui
