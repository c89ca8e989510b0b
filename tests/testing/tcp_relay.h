// A network between client and server that can break without either dying.
#ifndef GELENK_TESTS_TESTING_TCP_RELAY_H_
#define GELENK_TESTS_TESTING_TCP_RELAY_H_

#include <string>
#include <thread>
#include <vector>

namespace gelenk::testing {

// Passes bytes between a port of its own and `server_port`, both on loopback,
// in a thread of its own. Thread-safe.
class TcpRelay {
 public:
  explicit TcpRelay(int server_port);
  ~TcpRelay();
  TcpRelay(const TcpRelay&) = delete;
  TcpRelay& operator=(const TcpRelay&) = delete;

  // 127.0.0.1:<port>
  std::string target() const;

  // Resets the connections that there are, on both sides.
  void Cut() { Command('c'); }
  // The connections that there are pass on what the client says, and keep back
  // what the server answers.
  void Deafen() { Command('d'); }
  // The connections that there are stay open and pass nothing any more: as
  // after a cable was pulled. New ones work. Cut ends them, too.
  void Freeze() { Command('f'); }

 private:
  struct Pair {
    int client = -1;
    int server = -1;
    bool passes_requests = true;
    bool passes_answers = true;
  };

  void Command(char command);
  void Run();
  void Obey(char command);
  void Accept();
  // False when the pair is at its end.
  static bool Pass(int from, int to);

  const int server_port_;
  int port_ = 0;
  int listener_ = -1;
  int commands_[2] = {-1, -1};  // a pipe: read end, write end
  std::vector<Pair> pairs_;     // of the thread
  std::thread thread_;
};

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_TCP_RELAY_H_
