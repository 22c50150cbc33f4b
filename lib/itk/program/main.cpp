// SPDX-License-Identifier: GPL-3.0-or-later
// trephine-itk: what the other programs have ITK do. It only works as their bounded child.
#include <itkMultiThreaderBase.h>
#include <itkObject.h>

#include <cstdio>

#include "base/child.h"
#include "base/exit_code.h"

int main(int argc, char** argv) {
  // One thread and one work unit in every filter: sums do not depend on the machine. What can run at once, we run at
  // once.
  ::itk::MultiThreaderBase::SetGlobalDefaultThreader(::itk::MultiThreaderBase::ThreaderEnum::Platform);
  ::itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(1);
  ::itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
  ::itk::Object::SetGlobalWarningDisplay(false);  // a warning may quote the file that is read
  trephine::run_child_if_asked(argc, argv);
  std::fputs("trephine-itk: is started by trephine where it needs ITK, and does nothing by itself\n", stderr);
  return static_cast<int>(trephine::ExitCode::usage);
}
