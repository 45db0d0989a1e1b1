/* Does what only a program of Windows can do to another program (tests/machines/test_machine.py).
 *
 *     hold FILE                    opens a file that nobody can replace or remove, prints a line, and waits for stdin
 *     break PROGRAM ARGUMENT...    starts a program, interrupts it by Ctrl-C as soon as it has a temporary file in this
 *                                  folder, and ends with its exit code
 */
#include <stdio.h>
#include <string.h>
#include <wchar.h>
#include <windows.h>

static int hold(const wchar_t* name) {
  const HANDLE file = CreateFileW(name, GENERIC_READ, FILE_SHARE_READ, NULL, OPEN_EXISTING, 0, NULL);
  if (file == INVALID_HANDLE_VALUE) return 1;
  puts("held");
  fflush(stdout);
  (void)getchar();
  return CloseHandle(file) ? 0 : 1;
}

static BOOL WINAPI ignore(DWORD event) {
  (void)event;
  return TRUE;
}

static int interrupt(const wchar_t* arguments) {
  static wchar_t line[32768];
  STARTUPINFOW start;
  PROCESS_INFORMATION process;
  WIN32_FIND_DATAW found;
  HANDLE search = INVALID_HANDLE_VALUE;
  DWORD code = 1;
  wcsncpy(line, arguments, 32767);
  memset(&start, 0, sizeof start);
  start.cb = sizeof start;
  if (!CreateProcessW(NULL, line, NULL, NULL, TRUE, 0, NULL, NULL, &start, &process)) return 1;
  while (search == INVALID_HANDLE_VALUE && WaitForSingleObject(process.hProcess, 1) == WAIT_TIMEOUT)
    search = FindFirstFileW(L".chronormal-*", &found);
  if (search != INVALID_HANDLE_VALUE) FindClose(search);
  SetConsoleCtrlHandler(ignore, TRUE);
  if (!GenerateConsoleCtrlEvent(CTRL_C_EVENT, 0)) return 1;
  WaitForSingleObject(process.hProcess, INFINITE);
  GetExitCodeProcess(process.hProcess, &code);
  printf("%08lX\n", code);
  return 0;
}

int wmain(int count, wchar_t** arguments) {
  if (count == 3 && wcscmp(arguments[1], L"hold") == 0) return hold(arguments[2]);
  if (count > 2 && wcscmp(arguments[1], L"break") == 0) return interrupt(wcsstr(GetCommandLineW(), L"break") + 6);
  return 2;
}
