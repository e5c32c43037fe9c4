# shellcheck shell=bash
# Why a part of the set-up has failed, by what its log holds.

# Each row: a pattern in the log | what it means and what to do. The first that is found counts.
CAUSES='
No space left on device|The disk is full: df -h shows where, apt-get clean frees some.
Read-only file system|The file system is mounted read-only: choose another workspace with MY_SIMULATIONS_WS.
dpkg was interrupted|An earlier installation was interrupted. As root: dpkg --configure -a && apt-get -f install
Unmet dependencies|Packages are half installed. As root: apt-get -f install
held broken packages|Packages of another source or release stand in the way: apt-cache policy shows which.
Could not get lock|Another package manager is running. Wait until it has ended, or end it.
is not valid yet|The clock of this machine is wrong: date
certificate verify failed|CERT
CERTIFICATE_VERIFY_FAILED|CERT
SSL certificate problem|CERT
SELF_SIGNED_CERT_IN_CHAIN|CERT
UNABLE_TO_GET_ISSUER_CERT|CERT
UNABLE_TO_VERIFY_LEAF_SIGNATURE|CERT
407 Proxy|PROXY
Proxy Authentication Required|PROXY
Cannot connect to proxy|PROXY
Temporary failure resolving|NETWORK
Temporary failure in name resolution|NETWORK
Name or service not known|NETWORK
Network is unreachable|NETWORK
EAI_AGAIN|NETWORK
ENOTFOUND|NETWORK
ECONNREFUSED|NETWORK
Connection timed out|NETWORK
ETIMEDOUT|NETWORK
404  Not Found|The package lists are older than the archive. As root: apt-get update
Unable to locate package|This release has no package of that name, or its part of the archive is not enabled (on Ubuntu: add-apt-repository universe).
Python.h: No such file|The headers of Python are missing. As root: apt-get install python3-dev
cc1plus: not found|COMPILER
gcc: not found|COMPILER
No such file or directory: .*g++|COMPILER
No such file or directory: .*gcc|COMPILER
g++. failed: No such file|COMPILER
gcc. failed: No such file|COMPILER
command .*gcc.* failed: No such file|COMPILER
No CMAKE_CXX_COMPILER could be found|COMPILER
Killed signal terminated program|MEMORY
virtual memory exhausted|MEMORY
Cannot allocate memory|MEMORY
no such option|The pip of this environment is too old: remove the folder .my_simulations/venv of the workspace.
ensurepip is not available|Python cannot make environments. As root: apt-get install python3-venv
THESE PACKAGES DO NOT MATCH THE HASHES|What was fetched is not what is pinned: something between here and the package index changes files.
Unsupported engine|The Node.js here is too old: remove it from PATH, and the one of the system is used.
No matching distribution found|The package index has no such version for this Python and processor.
Could not find a package configuration file|A package of the workspace needs one that is not installed: apt-cache search finds it by its name.
Permission denied|A file belongs to someone else: ls -l shows its owner. Set-up as root leaves such files behind.
'

# cause_in LOG: the advice for the first known cause that the log holds, or nothing.
cause_in() {
  local row pattern advice
  while IFS= read -r row; do
    pattern=${row%%|*}
    [ -n "$pattern" ] || continue
    grep -q -e "$pattern" -- "$1" 2>/dev/null || continue
    advice=${row#*|}
    case $advice in
      CERT) advice="A certificate on the way to the package index is not known here: set \
SSL_CERT_FILE, PIP_CERT and NODE_EXTRA_CA_CERTS to the bundle that holds your proxy's." ;;
      PROXY) advice="The proxy refuses: check http_proxy and https_proxy." ;;
      NETWORK) advice="The network does not answer, or the names of its hosts do not resolve; \
behind a proxy, set http_proxy and https_proxy." ;;
      COMPILER) advice="There is no compiler. As root: apt-get install build-essential" ;;
      MEMORY) advice="The memory is too small for that: end other programs, or add swap." ;;
    esac
    printf '%s' "$advice"
    return
  done <<<"$CAUSES"
}
