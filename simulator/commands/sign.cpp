// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>

#include "cli/argument.h"
#include "cli/command.h"
#include "lessons/signature.h"

namespace trephine::commands {
namespace {

ExitCode run_sign(const cli::ParsedCommand& parsed) {
  lessons::sign_recording(parsed.path("recording"), parsed.path("key"));
  std::cout << lessons::signature_file(parsed.path("recording")).string() << "\n";
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand sign_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "sign";
  c.summary = "a teacher signs a recording that he saw being made";
  c.description =
      "Writes RECORDING.sig beside the recording: its SHA-256, signed with the teacher's private key (Ed25519, a PEM "
      "file without a passphrase that only he can read). score and exercise then say with --signed-by PUBLIC_KEY which "
      "attempts are signed, and refuse a recording that is another than the one that was signed.";
  cli::Argument recording = cli::argument("recording", Kind::in_file, "The recording of a lesson.");
  recording.positional = recording.required = true;
  cli::Argument key = cli::argument("key", Kind::in_file, "The teacher's private key (PEM).");
  key.required = true;
  c.arguments = {recording, key};
  c.examples = {"trephine-sim sign one.lesson --key teacher.key"};
  c.run = run_sign;
  return c;
});

}  // namespace trephine::commands
